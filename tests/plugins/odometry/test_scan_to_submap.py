"""Scan-to-submap odometry in a room of planes, whose motion is known."""

import numpy as np
import pytest

from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import angle_between, from_rpy
from executive.messages.lidar import LidarScan
from plugins.odometry.scan_to_submap import ScanToSubmap, ScanToSubmapSettings
from plugins.odometry.sweep import undistort

FRAME = "lidar_horizontal"
# Ground, walls of a yard and two blocks, as (normal, offset): n·p = d.
PLANES = np.array(
    [[0, 0, 1, -2.0], [1, 0, 0, 12.0], [-1, 0, 0, 9.0], [0, 1, 0, 10.0], [0, -1, 0, 8.0], [0.6, 0.8, 0, 9.0]]
)


def turned(t: float, rate_rad_s: float) -> np.ndarray:
    """A sensor 1.2 m from the axis of a cabin that turns evenly."""
    R = from_rpy(0, 0, rate_rad_s * t)
    return pose(R, R @ np.array([1.2, 0, 0]))


def scan(end_s: float, rate_rad_s: float, rng: np.random.Generator) -> LidarScan:
    """One revolution of 0.1 s, each return cast from where the sensor is at its own time."""
    azimuth = np.repeat(np.arange(450) * 2 * np.pi / 450, 16)
    elevation = np.tile(np.radians(np.linspace(-15, 15, 16)), 450)
    stamps = end_s - 0.1 + 0.1 * np.repeat(np.arange(1, 451) / 450, 16)
    directions = np.c_[np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    poses = np.array([turned(t, rate_rad_s) for t in stamps[::16]]).repeat(16, axis=0)
    directions_map = np.einsum("nij,nj->ni", poses[:, :3, :3], directions)
    with np.errstate(divide="ignore", invalid="ignore"):
        ranges = (PLANES[:, 3] - poses[:, :3, 3] @ PLANES[:, :3].T) / (directions_map @ PLANES[:, :3].T)
    ranges = np.where(ranges > 0.1, ranges, np.inf).min(axis=1) + rng.normal(0, 0.01, len(directions))
    seen = ranges < 50
    return LidarScan(end_s, FRAME, (directions * ranges[:, None])[seen], stamps[seen])


@pytest.fixture
def odometry() -> ScanToSubmap:
    odometry = ScanToSubmap(ScanToSubmapSettings())
    odometry.start()
    return odometry


def test_the_first_scan_gives_no_increment(odometry: ScanToSubmap) -> None:
    assert odometry.add_scan(scan(0.1, 0.0, np.random.default_rng(0))) is None


@pytest.mark.parametrize("rate_rad_s", [0.0, 0.6])
def test_the_chain_of_increments_is_the_sensors_motion(odometry: ScanToSubmap, rate_rad_s: float) -> None:
    rng = np.random.default_rng(1)
    T_start_now, start_s, now_s = np.eye(4), None, None
    for k in range(1, 26):
        increment = odometry.add_scan(scan(k * 0.1, rate_rad_s, rng))
        if increment is not None:
            start_s = increment.from_s if start_s is None else start_s
            assert now_s is None or increment.from_s == now_s
            T_start_now, now_s = T_start_now @ increment.T_from_to, increment.to_s
    assert now_s == pytest.approx(2.5)
    truth = inverse(turned(start_s, rate_rad_s)) @ turned(2.5, rate_rad_s)
    # The first scan of a turning sensor is taken as undistorted: 0.03 rad over its revolution.
    assert angle_between(T_start_now[:3, :3], truth[:3, :3]) < 0.002 + 0.05 * rate_rad_s
    assert np.linalg.norm(T_start_now[:3, 3] - truth[:3, 3]) < 0.01 + 0.1 * rate_rad_s


def test_scans_of_another_lidar_are_left_alone(odometry: ScanToSubmap) -> None:
    other = LidarScan(0.1, "lidar_vertical", np.ones((100, 3)) * 5, np.full(100, 0.1))
    assert odometry.add_scan(other) is None
    odometry.add_scan(scan(0.1, 0.0, np.random.default_rng(0)))
    assert odometry.add_scan(scan(0.2, 0.0, np.random.default_rng(1))) is not None


def test_a_scan_of_another_place_is_refused_and_the_track_goes_on(odometry: ScanToSubmap) -> None:
    rng = np.random.default_rng(2)
    odometry.add_scan(scan(0.1, 0.0, rng))
    nowhere = LidarScan(0.2, FRAME, rng.uniform(-40, 40, (3000, 3)), np.full(3000, 0.2))
    assert odometry.add_scan(nowhere) is None
    increment = odometry.add_scan(scan(0.3, 0.0, rng))
    assert increment is not None
    assert (increment.from_s, increment.to_s) == (0.1, 0.3)


def test_an_empty_scan_gives_nothing(odometry: ScanToSubmap) -> None:
    odometry.add_scan(scan(0.1, 0.0, np.random.default_rng(2)))
    assert odometry.add_scan(LidarScan(0.2, FRAME, np.zeros((0, 3)), np.zeros(0))) is None


def test_undistortion_by_the_true_motion_leaves_a_still_picture() -> None:
    rng = np.random.default_rng(3)
    rate = 0.8
    moving = scan(0.1, rate, rng)
    T_from_to = inverse(turned(0.0, rate)) @ turned(0.1, rate)
    points = undistort(moving, T_from_to, 0.1) @ turned(0.1, rate)[:3, :3].T + turned(0.1, rate)[:3, 3]
    distance = np.abs(points @ PLANES[:, :3].T - PLANES[:, 3]).min(axis=1)
    assert np.median(distance) < 0.015  # the range noise is 10 mm
