"""A step of the biases: what it does to a state, and how large it must be to explain a fix."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    ACCEL_BIAS,
    DIMENSION,
    GYRO_BIAS,
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
    propagate,
)
from executive_plugins.estimation.kalman.bias_step import (
    explaining_factor,
    grown,
    left,
    step_covariance,
)
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from scipy.stats import chi2

from executive.arrays import Float
from executive.geometry.rotation import from_rpy, log_so3

Z = np.zeros(3)
UP = np.array([0.0, 0.0, 9.81])
NOISE = InertialNoise(1e-3, 1e-2, 1e-6, 1e-5, 1e-2, 9.81, 1e-3)


def after(seconds: float, gyro_bias: Float, accel_bias: Float) -> InertialState:
    """A body at rest, as it is reckoned with biases that it has not."""
    R = from_rpy(0.1, -0.05, 1.0)
    force = R.T @ UP
    state = InertialState(Inertial(0.0, Z, force, 0.01), R, Z, Z, gyro_bias, accel_bias)
    for k in range(1, round(100 * seconds) + 1):
        state = propagate(state, Inertial(k / 100, Z, force, 0.01), 9.81)
    return state


def test_it_is_what_reckoning_with_a_step_gives() -> None:
    seconds, rate, force = 0.8, 1e-4, 1e-3
    state = after(seconds, Z, Z)
    expected = np.zeros((DIMENSION, DIMENSION))
    for axis in np.eye(3):
        for gyro, accel in ((rate * axis, Z), (Z, force * axis)):
            other, error = after(seconds, gyro, accel), np.zeros(DIMENSION)
            error[ROTATION] = log_so3(state.R_map_imu.T @ other.R_map_imu)
            error[VELOCITY], error[POSITION] = other.v_map_imu, other.p_map_imu
            error[GYRO_BIAS], error[ACCEL_BIAS] = gyro, accel
            expected += np.outer(error, error)
    found = step_covariance(state, seconds, rate, force)
    size = np.sqrt(np.maximum(np.diag(found), 1e-14))
    # Both are of first order in the step; the reckoning's steps are of 10 ms.
    assert (np.abs(found - expected) / np.outer(size, size)).max() < 0.03


@pytest.mark.parametrize("size", [3.0, 20.0])
def test_with_the_factor_one_innovation_in_twenty_is_smaller(size: float) -> None:
    A = np.random.default_rng(3).normal(0, 1, (3, 3))
    S, more, residual = np.eye(3), A @ A.T, size * np.array([0.6, -0.64, 0.48])
    factor = explaining_factor(residual, S, more, 1e9)
    distance2 = residual @ np.linalg.solve(S + factor * more, residual)
    assert distance2 == pytest.approx(chi2.ppf(0.05, 3))


def test_a_usual_innovation_needs_no_factor_and_a_large_one_gets_the_largest() -> None:
    S, more = np.eye(3), np.diag([1.0, 0.0, 0.0])
    assert explaining_factor(np.array([0.0, 1.0, 1.0]), S, more, 1.0) == 0.0
    assert explaining_factor(np.array([0.0, 9.0, 9.0]), S, more, 1.0) == pytest.approx(1.0)


def in_motion() -> ErrorStateFilter:
    """A filter whose clock is known to 0.1 s, at 5 m/s."""
    speed = np.array([5.0, 0.0, 0.0])
    state = InertialState(Inertial(0.0, Z, UP, 0.01), np.eye(3), Z, speed, Z, Z)
    P = np.diag(np.repeat([0.01, 0.1, 0.05, 1e-3, 1e-2], 3) ** 2)
    cross = np.zeros(DIMENSION)
    cross[POSITION] = speed * 0.1**2
    P[POSITION, POSITION] += np.outer(speed, speed) * 0.1**2
    return ErrorStateFilter(state, P, NOISE, ClockOffset(0.0, 0.1, cross))


def corrected(kalman: ErrorStateFilter) -> ErrorStateFilter:
    H, by_clock = np.zeros((3, DIMENSION)), np.array([-1.0, 0.0, 0.0])
    H[:, POSITION] = np.eye(3)
    assert kalman.correct(np.array([0.1, 0.2, -0.1]), H, 1e-4 * np.eye(3), 1e3, by_clock)
    return kalman


def test_a_clock_that_is_held_stays_and_the_position_follows() -> None:
    free, held = in_motion(), in_motion()
    held.holds_clock = True
    assert abs(corrected(free).clock_s) > 1e-3
    assert corrected(held).clock_s == 0.0
    assert held.clock_std_s == pytest.approx(0.1, rel=1e-3)
    assert held.state.p_map_imu == pytest.approx([0.1, 0.2, -0.1], abs=0.05)
    assert np.linalg.eigvalsh(held.covariance).min() > 0


def test_a_clock_that_is_taken_back_is_as_uncertain_as_it_had_moved() -> None:
    kalman = corrected(in_motion())
    std_s, moved_s = kalman.clock_std_s, kalman.clock_s
    kalman.restore_clock(0.0)
    assert kalman.clock_s == 0.0
    assert kalman.clock_std_s == pytest.approx(np.hypot(std_s, moved_s))


def test_an_explained_innovation_opens_the_biases() -> None:
    kalman, H = in_motion(), np.zeros((3, DIMENSION))
    H[:, POSITION] = np.eye(3)
    noise, residual = 1e-4 * np.eye(3), np.array([0.0, 0.1, 0.0])
    kalman.explain(residual, (H, None), noise, 1.0)
    S = kalman.predicted(H) + noise
    assert residual @ np.linalg.solve(S, residual) == pytest.approx(chi2.ppf(0.05, 3), rel=1e-3)
    assert np.diag(kalman.covariance)[GYRO_BIAS].min() > (10 * 1e-3) ** 2


def test_the_mean_of_several_innovations_counts_as_such() -> None:
    """A quarter of the variance: half of the innovation shows as much."""
    kalman, other, H = in_motion(), in_motion(), np.zeros((3, DIMENSION))
    H[:, POSITION] = np.eye(3)
    noise, innovation = 1e-4 * np.eye(3), np.array([0.0, 0.3, 0.0])
    kalman.explain(innovation, (H, None), noise, 1.0, 0.25)
    other.explain(innovation, (H, None), noise, 1.0)
    S = kalman.predicted(H) - in_motion().predicted(H) + 0.25 * (in_motion().predicted(H) + noise)
    assert innovation @ np.linalg.solve(S, innovation) == pytest.approx(chi2.ppf(0.05, 3), rel=0.01)
    assert np.trace(kalman.covariance) > np.trace(other.covariance)


def test_no_more_than_a_step_of_the_usual_motion_is_added_in_all() -> None:
    kalman, H = in_motion(), np.zeros((3, DIMENSION))
    H[:, POSITION] = np.eye(3)
    for _ in range(5):
        kalman.explain(np.array([0.0, 90.0, 0.0]), (H, None), 1e-4 * np.eye(3), 1.0)
    stds = np.sqrt(np.diag(kalman.covariance))
    assert max(stds[GYRO_BIAS].max() / 0.8, stds[ACCEL_BIAS].max()) == pytest.approx(1.0, rel=0.01)
    assert left(kalman.covariance, 0.8, 1.0) == pytest.approx(0.0, abs=0.01)


def test_biases_that_fade_stay_within_a_step() -> None:
    P = np.diag(np.repeat([0.01, 0.1, 0.05, 0.2, 0.3], 3) ** 2)
    more = grown(P, 100.0, 0.8, 0.1)
    assert more[[0, 3, 6]] == pytest.approx(10.0)
    assert more[GYRO_BIAS] == pytest.approx(4.0)
    assert more[ACCEL_BIAS] == pytest.approx(1.0)  # known worse than that before
