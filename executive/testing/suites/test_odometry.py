"""What every lidar odometry must do, whatever its method."""

import numpy as np

from executive.interfaces.odometry import LidarOdometry
from executive.messages.lidar import LidarScan
from executive.testing.exercises.odometry import FRAME, scan
from executive.testing.pytest_plugin import Insist

CAPABILITY = "odometry"


def test_the_first_scan_gives_nothing(plugin: LidarOdometry) -> None:
    assert plugin.add_scan(scan(0.1)) is None


def test_a_sensor_at_rest_does_not_move(plugin: LidarOdometry, insist: Insist) -> None:
    T = np.eye(4)
    for k in range(1, 8):
        increment = plugin.add_scan(scan(k / 10))
        if increment is not None:
            assert increment.frame == FRAME
            assert increment.from_s < increment.to_s
            assert (np.linalg.eigvalsh(increment.covariance) > 0).all()
            T = T @ increment.T_from_to
    insist(increment is not None, "it matches no scan of a yard at rest")
    np.testing.assert_allclose(T, np.eye(4), atol=0.02)


def test_the_same_scan_twice_gives_nothing_the_second_time(plugin: LidarOdometry) -> None:
    plugin.add_scan(scan(0.1))
    assert plugin.add_scan(scan(0.1)) is None


def test_an_empty_scan_gives_nothing(plugin: LidarOdometry) -> None:
    plugin.add_scan(scan(0.1))
    assert plugin.add_scan(LidarScan(0.2, FRAME, np.zeros((0, 3)), np.zeros(0))) is None


def test_a_long_silence_gives_no_increment_and_begins_anew(
    plugin: LidarOdometry, insist: Insist
) -> None:
    for k in range(1, 4):
        plugin.add_scan(scan(k / 10))
    assert plugin.add_scan(scan(60.0)) is None
    increment = plugin.add_scan(scan(60.1))
    insist(increment is not None, "it matches no scan of a yard at rest")
    assert increment is not None
    assert (increment.from_s, increment.to_s) == (60.0, 60.1)
