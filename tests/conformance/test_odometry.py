"""What every lidar odometry must do, whatever its method."""

from collections.abc import Iterator

import numpy as np
import pytest

from executive import registry
from executive.interfaces.odometry import LidarOdometry
from executive.machine.machine import load_machine
from executive.messages.lidar import LidarScan

FRAME = "lidar_horizontal"


@pytest.fixture(params=[plugin.name for plugin in registry.installed("odometry")])
def odometry(request: pytest.FixtureRequest) -> Iterator[LidarOdometry]:
    plugin = registry.load("odometry", request.param)
    services = {"machine": load_machine("m545"), "rng": np.random.default_rng(0)}
    odometry = plugin(
        plugin.Settings(), *(services[name] for name in registry.dependencies_of(plugin))
    )
    odometry.start()
    yield odometry
    odometry.close()


def scan(stamp_s: float) -> LidarScan:
    """A still revolution in a yard: ground, four walls."""
    azimuth, elevation = np.meshgrid(
        np.linspace(0, 2 * np.pi, 400, endpoint=False), np.radians(np.linspace(-15, 15, 16))
    )
    directions = np.stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ],
        axis=-1,
    ).reshape(-1, 3)
    planes = np.array([[0, 0, -1, 2], [1, 0, 0, 11], [-1, 0, 0, 9], [0, 1, 0, 10], [0, -1, 0, 8]])
    with np.errstate(divide="ignore"):
        ranges = planes[:, 3] / (directions @ planes[:, :3].T)
    ranges = np.where(ranges > 0, ranges, np.inf).min(axis=1)
    ranges = ranges + np.random.default_rng(round(1000 * stamp_s)).normal(0, 0.01, len(ranges))
    return LidarScan(stamp_s, FRAME, directions * ranges[:, None], np.full(len(ranges), stamp_s))


def test_it_is_an_odometry(odometry: LidarOdometry) -> None:
    assert isinstance(odometry, LidarOdometry)


def test_the_first_scan_gives_nothing(odometry: LidarOdometry) -> None:
    assert odometry.add_scan(scan(0.1)) is None


def test_a_sensor_at_rest_does_not_move(odometry: LidarOdometry) -> None:
    T = np.eye(4)
    for k in range(1, 8):
        increment = odometry.add_scan(scan(k / 10))
        if increment is not None:
            assert increment.frame == FRAME
            assert increment.from_s < increment.to_s
            assert (np.linalg.eigvalsh(increment.covariance) > 0).all()
            T = T @ increment.T_from_to
    assert increment is not None
    np.testing.assert_allclose(T, np.eye(4), atol=0.02)


def test_the_same_scan_twice_gives_nothing_the_second_time(odometry: LidarOdometry) -> None:
    odometry.add_scan(scan(0.1))
    assert odometry.add_scan(scan(0.1)) is None


def test_an_empty_scan_gives_nothing(odometry: LidarOdometry) -> None:
    odometry.add_scan(scan(0.1))
    assert odometry.add_scan(LidarScan(0.2, FRAME, np.zeros((0, 3)), np.zeros(0))) is None


def test_a_long_silence_gives_no_increment_and_begins_anew(odometry: LidarOdometry) -> None:
    for k in range(1, 4):
        odometry.add_scan(scan(k / 10))
    assert odometry.add_scan(scan(60.0)) is None
    increment = odometry.add_scan(scan(60.1))
    assert increment is not None
    assert (increment.from_s, increment.to_s) == (60.0, 60.1)
