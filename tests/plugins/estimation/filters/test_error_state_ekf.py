"""The filter with lidar: drift in an outage, and the covariance of the clone."""

import numpy as np
import pytest
from executive_plugins.estimation.filters.cloning_filter import CloningFilter
from executive_plugins.estimation.filters.error_state_ekf import ErrorStateEkf
from executive_plugins.estimation.filters.settings import ErrorStateEkfSettings
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState, retract

from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import exp_so3, from_rpy, log_so3
from executive.messages.gnss import GnssFix
from executive.messages.odometry import LidarIncrement

NOISE = InertialNoise(1e-3, 1e-2, 1e-5, 1e-4, 0.03, 9.81, 0.01)
STD = np.repeat([0.003, 0.02], 3)


def increments(cabin, machine, end_s):
    """Yield noisy motions of the lidar at 10 Hz."""
    rng = np.random.default_rng(5)
    T_cabin_lidar = machine.sensors["lidar_horizontal"].T_link_sensor
    for k in range(1, round(10 * end_s)):
        a, b = ((k - 1) / 10, k / 10)
        T = inverse(cabin.T_map_cabin(a) @ T_cabin_lidar) @ cabin.T_map_cabin(b) @ T_cabin_lidar
        error = rng.normal(0, STD)
        T = T @ pose(exp_so3(error[:3]), error[3:])
        yield LidarIncrement(a, b, "lidar_horizontal", T, np.diag(STD**2))


def outage_error(cabin, machine, with_lidar):
    """Return the largest position error [m] in an outage of ten seconds while the cabin swings."""
    estimator = ErrorStateEkf(ErrorStateEkfSettings(standing={"is_used": False}), machine)
    estimator.start()
    waiting = list(increments(cabin, machine, 20.0)) if with_lidar else []
    worst = 0.0
    for observation in cabin.observations(18.0):
        if isinstance(observation, GnssFix) and 7 < observation.stamp_s < 17:
            continue
        estimator.add(observation)
        while waiting and waiting[0].to_s <= observation.stamp_s:
            estimator.add_odometry(waiting.pop(0))
        if 7 < observation.stamp_s < 17 and round(observation.stamp_s * 100) % 10 == 0:
            state = estimator.state()
            worst = max(
                worst, np.linalg.norm((state.T_map_cabin - cabin.T_map_cabin(state.stamp_s))[:3, 3])
            )
    assert "odometry lidar_horizontal: outlier" not in estimator.refused
    return worst


def test_lidar_bounds_the_drift_in_an_outage(cabin, machine):
    with_lidar = outage_error(cabin, machine, with_lidar=True)
    assert with_lidar < 0.5  # a hundred increments of 2 cm and 3 mrad each
    assert with_lidar < 0.7 * outage_error(cabin, machine, with_lidar=False)


def cloned(clock=None):
    """Return a filter that has moved for a tenth of a second since it was cloned."""
    rng = np.random.default_rng(2)
    A = rng.normal(0, 0.05, (15, 15))
    state = InertialState(
        Inertial(0.0, np.zeros(3), np.array([0, 0, 9.81])),
        from_rpy(0.1, -0.2, 0.7),
        np.array([1.0, 2.0, 3.0]),
        np.array([0.5, -0.2, 0.1]),
        np.zeros(3),
        np.zeros(3),
    )
    given = () if clock is None else (clock,)
    kalman = CloningFilter(state, A @ A.T + 1e-4 * np.eye(15), NOISE, *given)
    kalman.clone()
    for k in range(1, 11):
        kalman.predict(
            Inertial(k / 100, np.array([0.3, -0.1, 0.5]), np.array([0.4, 0.1, 9.9]), 0.01)
        )
    return kalman


@pytest.fixture
def kalman():
    return cloned()


def moved(kalman):
    """Return the motion since the clone that the filter predicts, shape (4, 4)."""
    R = kalman._R.T
    return pose(R @ kalman.state.R_map_imu, R @ (kalman.state.p_map_imu - kalman._p))


def test_with_a_clock_the_clone_comes_after_it_and_the_clock_tells_nothing_of_the_motion():
    plain, kalman = cloned(), cloned(ClockOffset(0.0, 0.05, np.full(15, 1e-4)))
    assert kalman.has_clone_at(0.0)
    T = moved(kalman)
    noise = 1e-4 * np.eye(6)
    told, expected = kalman.increment(T, noise), plain.increment(T, noise)
    assert told.H.shape == (6, 22)
    np.testing.assert_array_equal(told.H[:, 15], 0.0)
    np.testing.assert_allclose(np.delete(told.H, 15, axis=1), expected.H, atol=1e-12)
    np.testing.assert_allclose(told.residual, expected.residual, atol=1e-12)
    np.testing.assert_allclose(told.predicted, expected.predicted, atol=1e-12)
    off = T @ pose(exp_so3(np.array([0.002, 0, -0.001])), np.array([0.003, -0.002, 0.001]))
    assert kalman.correct_by_increment(kalman.increment(off, 1e-12 * np.eye(6)), 1e9)
    np.testing.assert_allclose(moved(kalman), off, atol=1e-4)


def test_the_derivative_by_both_errors_is_that_of_finite_differences(kalman):
    T = pose(
        kalman._R.T @ kalman.state.R_map_imu, kalman._R.T @ (kalman.state.p_map_imu - kalman._p)
    )
    residual, H, _ = kalman._increment_residual(T)
    np.testing.assert_allclose(residual, 0, atol=1e-12)
    R, p, state = kalman._R, kalman._p, kalman.state
    for i in range(21):
        error = np.zeros(21)
        error[i] = 1e-6
        kalman.state = retract(state, error[:15])
        row = kalman.block[0]
        row["clone_R"], row["clone_p"] = R @ exp_so3(error[15:18]), p + error[18:]
        # Measured minus predicted: the prediction rises by H · error.
        np.testing.assert_allclose(-kalman._increment_residual(T)[0] / 1e-6, H[:, i], atol=1e-4)
        kalman.state, row["clone_R"], row["clone_p"] = state, R, p


def test_an_exact_increment_fixes_the_relative_pose(kalman):
    T = pose(
        kalman._R.T @ kalman.state.R_map_imu, kalman._R.T @ (kalman.state.p_map_imu - kalman._p)
    )
    T = T @ pose(exp_so3(np.array([0.002, 0, -0.001])), np.array([0.003, -0.002, 0.001]))
    before = np.linalg.eigvalsh(kalman.covariance)
    assert kalman.correct_by_increment(kalman.increment(T, 1e-12 * np.eye(6)), 1e9)
    D = inverse(pose(kalman._R, kalman._p)) @ pose(kalman.state.R_map_imu, kalman.state.p_map_imu)
    # One step of a linearised filter over 4 mm and 2 mrad: what is left is of second order.
    np.testing.assert_allclose(D[:3, 3], T[:3, 3], atol=1e-4)
    np.testing.assert_allclose(log_so3(D[:3, :3].T @ T[:3, :3]), 0, atol=1e-4)
    assert (np.linalg.eigvalsh(kalman.covariance) > 0).all()
    assert np.linalg.eigvalsh(kalman.covariance).sum() < before.sum()


def test_a_fix_moves_the_clone_with_the_state(kalman):
    R, p = kalman._R, kalman._p
    H = np.zeros((3, 15))
    H[:, 6:9] = np.eye(3)
    P = np.block([[kalman.covariance, kalman._cross], [kalman._cross.T, kalman._own]])
    HF = np.hstack([H, np.zeros((3, 6))])
    noise, residual = 1e-4 * np.eye(3), np.array([0.01, -0.02, 0.03])
    K = P @ HF.T @ np.linalg.inv(HF @ P @ HF.T + noise)
    assert kalman.correct(residual, H, noise, 1e9)
    expected, error = (np.eye(21) - K @ HF) @ P, K @ residual
    # The correction turns what is left of the errors by up to half its angle.
    turned = float(np.linalg.norm(error[:3])) * np.abs(expected).max()
    np.testing.assert_allclose(kalman._cross, expected[:15, 15:], atol=turned)
    np.testing.assert_allclose(kalman._own, expected[15:, 15:], atol=turned)
    np.testing.assert_allclose(kalman._R, R @ exp_so3(error[15:18]), atol=1e-9)
    along = 0.5 * np.cross(R @ error[15:18], error[18:])
    np.testing.assert_allclose(kalman._p, p + error[18:] + along, atol=1e-5)


def test_an_increment_that_does_not_follow_the_last_one_only_clones(cabin, machine):
    estimator = ErrorStateEkf(ErrorStateEkfSettings(), machine)
    estimator.start()
    for observation in cabin.observations(4.0):
        estimator.add(observation)
    wild = pose(from_rpy(0, 0, 1.0), np.array([5.0, 0, 0]))
    estimator.add_odometry(LidarIncrement(3.7, 3.95, "lidar_horizontal", wild, np.diag(STD**2)))
    for observation in cabin.observations(6.0, 4.0):
        estimator.add(observation)
    state = estimator.state()
    assert np.linalg.norm((state.T_map_cabin - cabin.T_map_cabin(state.stamp_s))[:3, 3]) < 0.03
