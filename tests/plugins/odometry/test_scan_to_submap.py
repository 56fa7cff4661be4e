"""Scan-to-submap odometry in a yard of planes, whose motion is known."""

from itertools import pairwise

import numpy as np
import pytest
from executive_plugins.odometry.scan_to_submap import ScanToSubmap
from executive_plugins.odometry.settings import ScanToSubmapSettings

from executive.geometry.pose import inverse
from executive.geometry.rotation import angle_between, log_so3
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement

FRAME = "lidar_horizontal"
FLAT = np.array([[0, 0, 1, -2.0]])


def started(yard, **settings: float) -> ScanToSubmap:
    odometry = ScanToSubmap(ScanToSubmapSettings.model_validate(settings), yard.machine)
    odometry.start()
    return odometry


def followed(yard, until_s: float, has_imu: bool = True) -> list[LidarIncrement]:
    """Feed what the machine measures, and return the increments."""
    odometry, increments = started(yard), []
    for k in range(1, round(100 * until_s) + 1):
        if has_imu:
            odometry.add_imu(yard.imu(0.01 * k))
        odometry.add_joints(yard.joints(0.01 * k))
        if k % 10 == 0:
            increment = odometry.add_scan(yard.scan(0.01 * k))
            increments += [increment] if increment is not None else []
    return increments


@pytest.mark.parametrize(("rate_rad_s", "speed_m_s"), [(0.0, 0.0), (0.7, 0.0), (0.3, 1.0)])
def test_the_chain_of_increments_is_the_sensors_motion(
    yard, rate_rad_s: float, speed_m_s: float
) -> None:
    moving = yard(rate_rad_s=rate_rad_s, speed_m_s=speed_m_s)
    increments = followed(moving, 1.5)
    assert len(increments) >= 13
    T = np.eye(4)
    for before, after in pairwise(increments):
        assert before.to_s == after.from_s
    for increment in increments:
        T = T @ increment.T_from_to
    truth = moving.T_from_to(increments[0].from_s, increments[-1].to_s)
    assert angle_between(T[:3, :3], truth[:3, :3]) < 0.003
    # The first scan is taken as if the chassis stood: 0.1 m over its revolution, half of that on
    # average.
    assert np.linalg.norm(T[:3, 3] - truth[:3, 3]) < 0.015 + 0.05 * speed_m_s


def test_errors_of_increments_agree_with_their_covariance(yard) -> None:
    swinging = yard(rate_rad_s=0.7)
    nees = []
    for increment in followed(swinging, 2.0)[1:]:
        E = inverse(swinging.T_from_to(increment.from_s, increment.to_s)) @ increment.T_from_to
        error = np.concatenate([log_so3(E[:3, :3]), E[:3, 3]])
        nees.append(error @ np.linalg.solve(increment.covariance, error) / 6)
    assert (
        0.1 < np.mean(nees) < 1.5
    )  # the doubt is set for rough ground and stones, not for even walls


def test_level_ground_gives_a_large_covariance_of_heading(yard) -> None:
    increments = followed(yard(planes=FLAT), 0.5)
    assert increments
    R_lidar_world = yard().T_world_lidar(0.0)[:3, :3].T
    for increment in increments:
        heading_rad, height_m = (
            np.sqrt(R_lidar_world[:, 2] @ block @ R_lidar_world[:, 2])
            for block in (increment.covariance[:3, :3], increment.covariance[3:, 3:])
        )
        assert heading_rad > 0.009
        assert height_m < 0.006


def test_it_works_without_inertial_samples(yard) -> None:
    turning = yard(rate_rad_s=0.3)
    increments = followed(turning, 1.0, has_imu=False)
    T_from_to = turning.T_from_to(increments[-1].from_s, increments[-1].to_s)
    assert angle_between(increments[-1].T_from_to[:3, :3], T_from_to[:3, :3]) < 0.004


def test_scans_of_another_lidar_are_ignored(yard) -> None:
    odometry = started(yard())
    other = LidarScan(0.1, "lidar_vertical", np.ones((100, 3)) * 5, np.full(100, 0.1))
    assert odometry.add_scan(other) is None
    odometry.add_scan(yard().scan(0.1))
    assert odometry.add_scan(yard().scan(0.2)) is not None


def test_a_scan_of_another_place_is_refused_and_the_track_continues(yard) -> None:
    standing = yard()
    odometry = started(standing)
    odometry.add_scan(standing.scan(0.1))
    nowhere = np.random.default_rng(2).uniform(-40, 40, (3000, 3))
    assert odometry.add_scan(LidarScan(0.2, FRAME, nowhere, np.full(3000, 0.2))) is None
    increment = odometry.add_scan(standing.scan(0.3))
    assert increment is not None
    assert (increment.from_s, increment.to_s) == (0.1, 0.3)


def test_many_refusals_in_a_row_begin_a_new_submap(yard) -> None:
    here, there = (
        yard(),
        yard(planes=np.array([[0, 0, 1, -4.0], [1, 0, 0, 5.0], [0, 1, 0, 6.0], [-1, 0, 0, 30.0]])),
    )
    odometry = started(here)
    odometry.add_scan(here.scan(0.1))
    answers = [odometry.add_scan(there.scan(0.1 * k)) for k in range(2, 15)]
    assert answers[0] is None
    assert answers[-1] is not None
    np.testing.assert_allclose(answers[-1].T_from_to, np.eye(4), atol=0.02)
    most = odometry._settings.restart_after
    assert [answer is None for answer in answers] == [True] * most + [False] * (13 - most)
    assert answers[most].from_s == pytest.approx(0.1 * (most + 1))  # the last one refused


def test_an_empty_scan_gives_nothing(yard) -> None:
    odometry = started(yard())
    odometry.add_scan(yard().scan(0.1))
    assert odometry.add_scan(LidarScan(0.2, FRAME, np.zeros((0, 3)), np.zeros(0))) is None


def test_a_scan_twice_or_out_of_order_changes_nothing(yard) -> None:
    standing, odometry = yard(), started(yard())
    odometry.add_scan(standing.scan(0.2))
    assert odometry.add_scan(standing.scan(0.2)) is None
    assert odometry.add_scan(standing.scan(0.1)) is None
    increment = odometry.add_scan(standing.scan(0.3))
    assert (increment.from_s, increment.to_s) == (0.2, 0.3)


def test_after_a_gap_the_motion_is_unknown_and_a_new_map_begins(yard) -> None:
    standing, odometry = yard(), started(yard(), longest_gap_s=0.3)
    odometry.add_scan(standing.scan(0.1))
    assert odometry.add_scan(standing.scan(0.35)) is not None
    assert odometry.add_scan(standing.scan(0.7)) is None
    increment = odometry.add_scan(standing.scan(0.8))
    assert (increment.from_s, increment.to_s) == (0.7, 0.8)


@pytest.mark.parametrize("between", [False, True])
def test_so_many_refusals_in_a_row_begin_a_new_map(yard, between: bool) -> None:
    """A scan that matches in between makes the count begin anew."""
    here, odometry = yard(), started(yard(), restart_after=2)
    there = yard(planes=np.array([[0, 0, 1, -4.0], [1, 0, 0, 5.0], [0, 1, 0, 6.0]]))
    odometry.add_scan(here.scan(0.1))
    assert odometry.add_scan(there.scan(0.2)) is None
    if between:
        assert odometry.add_scan(here.scan(0.3)).from_s == 0.1
    assert odometry.add_scan(there.scan(0.4)) is None
    increment = odometry.add_scan(there.scan(0.5))
    assert increment is None if between else increment.from_s == 0.4


def test_a_scan_of_too_few_returns_begins_no_map(yard) -> None:
    standing, odometry = yard(), started(yard(), neighbours=6)
    few = np.random.default_rng(0).uniform(3.0, 9.0, (5, 3))
    assert odometry.add_scan(LidarScan(0.1, FRAME, few, np.full(5, 0.1))) is None
    assert odometry.add_scan(standing.scan(0.2)) is None
    assert odometry.add_scan(standing.scan(0.3)).from_s == 0.2


def test_a_rig_without_the_sensor_gives_nothing(yard) -> None:
    odometry = started(yard(), frame="lidar_of_another")
    sample = yard().scan(0.1)
    odometry.add_imu(yard().imu(0.1))
    odometry.add_joints(yard().joints(0.1))
    same = LidarScan(0.1, "lidar_of_another", sample.points_lidar, sample.point_stamps_s)
    assert odometry.add_scan(same) is None
