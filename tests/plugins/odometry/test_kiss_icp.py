"""KISS-ICP in a yard of planes, whose motion is known."""

import numpy as np
import pytest
from executive_plugins.odometry.kiss_icp import KissIcp
from executive_plugins.odometry.settings import KissIcpSettings

from executive.geometry.pose import inverse, transform
from executive.geometry.rotation import angle_between
from executive.messages.lidar import LidarScan

WORLD = np.random.default_rng(7).uniform(
    [-20, -20, -2], [20, 20, 4], (6000, 3)
)  # a thicket, seen from all sides


def thicket(yard, end_s: float) -> LidarScan:
    """The same points from wherever the sensor is; rings on bare planes would hold a point-to-point
    match still.
    """
    stamps = np.linspace(end_s - 0.1, end_s, 61)[1:]
    parts = np.array_split(WORLD, 60)
    points = [
        transform(inverse(yard.T_world_lidar(t)), part)
        for t, part in zip(stamps, parts, strict=True)
    ]
    return LidarScan(end_s, "lidar_horizontal", np.vstack(points), np.repeat(stamps, 100))


def started(yard) -> KissIcp:
    odometry = KissIcp(KissIcpSettings(), yard.machine)
    odometry.start()
    odometry.add_joints(yard.joints(0.0))
    return odometry


@pytest.mark.parametrize(("rate_rad_s", "speed_m_s"), [(0.0, 0.0), (0.7, 0.0), (0.3, 0.5)])
def test_a_motion_is_followed(yard, rate_rad_s: float, speed_m_s: float) -> None:
    moving = yard(rate_rad_s=rate_rad_s, speed_m_s=speed_m_s)
    odometry = started(moving)
    increments = []
    for k in range(1, 161):
        odometry.add_imu(moving.imu(0.01 * k))
        odometry.add_joints(moving.joints(0.01 * k))
        if k % 10 == 0:
            increments.append(odometry.add_scan(thicket(moving, 0.01 * k)))
    T = np.eye(4)
    for increment in increments[3:]:  # it learns the speed from the first ones
        T = T @ increment.T_from_to
    truth = moving.T_from_to(increments[3].from_s, increments[-1].to_s)
    assert angle_between(T[:3, :3], truth[:3, :3]) < 0.02
    assert np.linalg.norm(T[:3, 3] - truth[:3, 3]) < 0.06


def test_a_jump_is_refused_and_a_new_map_is_started(yard) -> None:
    standing = yard()
    odometry = KissIcp(KissIcpSettings(max_speed_m_s=0.5), standing.machine)
    odometry.start()
    for k in range(1, 4):
        odometry.add_scan(standing.scan(0.1 * k))
    scan = standing.scan(0.4)
    leapt = LidarScan(0.4, scan.frame, scan.points_lidar + [0.4, 0, 0], scan.point_stamps_s)
    assert odometry.add_scan(leapt) is None
    assert odometry.add_scan(standing.scan(0.5)) is None  # the first of a new map
    assert odometry.add_scan(standing.scan(0.6)) is not None


def test_the_same_scans_give_the_same_answers(yard) -> None:
    answers = []
    for _ in range(2):
        turning = yard(rate_rad_s=0.3)
        odometry = started(turning)
        answers.append(
            [odometry.add_scan(thicket(turning, 0.1 * k)) for k in range(1, 7)][-1].T_from_to
        )
    np.testing.assert_array_equal(*answers)


def test_scans_of_another_lidar_are_ignored(yard) -> None:
    odometry = started(yard())
    assert (
        odometry.add_scan(
            LidarScan(0.1, "lidar_vertical", np.ones((500, 3)) * 5, np.full(500, 0.1))
        )
        is None
    )
