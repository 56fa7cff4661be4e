"""Dead reckoning of a lidar on a turning cabin follows the truth where its assumptions hold."""

import numpy as np
import pytest
from executive_plugins.odometry.dead_reckoning import DeadReckoning

from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import exp_so3
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement


def fed(yard, until_s: float, has_imu: bool = True) -> DeadReckoning:
    reckoning = DeadReckoning(yard.machine, "lidar_horizontal")
    for k in range(round(100 * until_s) + 1):
        reckoning.add_joints(yard.joints(0.01 * k))
        if has_imu:
            reckoning.add_imu(yard.imu(0.01 * k))
    return reckoning


def increment(yard, from_s: float, std_m: float = 1e-4) -> LidarIncrement:
    """The true motion over 0.1 s, said to be so sure along each axis."""
    covariance = np.diag(np.repeat([1e-4, std_m], 3) ** 2)
    return LidarIncrement(
        from_s, from_s + 0.1, "lidar_horizontal", yard.T_from_to(from_s, from_s + 0.1), covariance
    )


def test_a_turning_cabin_on_a_chassis_at_rest_needs_no_earlier_increment(yard) -> None:
    turning = yard(rate_rad_s=0.7)
    path = fed(turning, 1.0).path(0.9, 1.0)
    np.testing.assert_allclose(path.T_end_then(0.9), turning.T_from_to(1.0, 0.9), atol=1e-9)


@pytest.mark.parametrize("rate_rad_s", [0.0, 0.7])
def test_a_constant_velocity_is_estimated_while_the_cabin_turns(yard, rate_rad_s: float) -> None:
    driving = yard(rate_rad_s=rate_rad_s, speed_m_s=1.0)
    reckoning = fed(driving, 2.0)
    for k in range(10):  # 1 mm of noise a scan leaves 1 cm/s after that
        reckoning.correct(increment(driving, 0.1 * k))
    error = reckoning.path(1.9, 2.0).T_end_then(1.9) - driving.T_from_to(2.0, 1.9)
    # The chord of an arc is taken for its middle's speed: 1 m/s · 0.1 s · (0.07 rad)²/24, twice.
    assert np.abs(error).max() < 2e-4


def test_without_a_gyroscope_the_last_rotation_is_continued(yard) -> None:
    turning = yard(rate_rad_s=0.7)
    reckoning = fed(turning, 1.0, has_imu=False)
    assert np.abs(reckoning.path(0.9, 1.0).T_end_then(0.9) - np.eye(4)).max() < 1e-9
    for k in range(10):
        reckoning.correct(increment(turning, 0.1 * k))
    np.testing.assert_allclose(
        reckoning.path(0.9, 1.0).T_end_then(0.9), turning.T_from_to(1.0, 0.9), atol=1e-3
    )


def test_an_uncertain_increment_changes_the_velocity_little(yard) -> None:
    driving = yard(speed_m_s=1.0)
    reckoned_m = []
    for std_m in (1e-4, 0.5):
        reckoning = fed(driving, 0.2)
        reckoning.correct(increment(driving, 0.0, std_m))
        reckoned_m.append(np.linalg.norm(reckoning.path(0.1, 0.2).T_end_then(0.1)[:3, 3]))
    np.testing.assert_allclose(reckoned_m, [0.1, 0.1 * 0.5**2 / (0.5**2 + 5.0**2)], rtol=0.05)


def test_turns_about_different_axes_are_composed_in_order_of_time(yard) -> None:
    machine = yard().machine
    cabin_imu, lidar = machine.sensors["imu_cabin"], machine.sensors["lidar_horizontal"]
    rates_cabin = [*[np.array([0.9, 0, 0])] * 5, *[np.array([0, 0, 1.2])] * 5]  # roll, then yaw
    reckoning = DeadReckoning(machine, "lidar_horizontal")
    truth = [np.eye(4)]
    for k, rate_cabin in enumerate(rates_cabin):
        rate_imu = cabin_imu.T_link_sensor[:3, :3].T @ rate_cabin
        reckoning.add_imu(ImuSample(0.01 * (k + 1), "imu_cabin", rate_imu, np.array([0, 0, 9.81])))
        truth.append(truth[-1] @ pose(exp_so3(0.01 * rate_cabin)))
    path = reckoning.path(0.0, 0.1)
    for k in (0, 5, 8, 10):
        T_end_then = inverse(truth[-1] @ lidar.T_link_sensor) @ truth[k] @ lidar.T_link_sensor
        np.testing.assert_allclose(path.T_end_then(0.01 * k), T_end_then, atol=1e-9)
