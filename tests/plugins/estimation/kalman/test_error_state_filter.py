"""Prediction and correction with an unknown clock, held against differences and Gauss."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
    retract,
)
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import fix_residual

from executive.arrays import Float
from executive.geometry.rotation import from_rpy, log_so3

NOISE = InertialNoise(1e-4, 2e-3, 1e-5, 1e-4, 0.03, 9.81, 1e-3)
CLOCK_S = 0.05
ARM = np.array([0.4, -1.1, 2.0])


def state(stamp_s: float = 3.0) -> InertialState:
    sample = Inertial(stamp_s, np.array([0.2, -0.1, 0.4]), np.array([1.0, 2.0, 9.0]), 0.01)
    return InertialState(
        sample,
        from_rpy(0.3, -0.2, 1.1),
        np.array([4.0, -2.0, 1.0]),
        np.array([6.0, 5.0, -1.0]),
        np.array([0.01, -0.02, 0.03]),
        np.array([0.1, 0.05, -0.2]),
    )


def covariance(n: int, seed: int = 0) -> Float:
    A = np.random.default_rng(seed).normal(0.0, 0.01, (n, 2 * n))
    return A @ A.T


def with_clock(seed: int = 0) -> ErrorStateFilter:
    P = covariance(DIMENSION + 1, seed)
    P *= np.outer(*[np.r_[np.ones(DIMENSION), CLOCK_S / np.sqrt(P[-1, -1])]] * 2)
    clock = ClockOffset(0.02, CLOCK_S, P[:DIMENSION, -1])
    return ErrorStateFilter(state(), P[:DIMENSION, :DIMENSION], NOISE, clock)


def joint(kalman: ErrorStateFilter) -> Float:
    """Return the covariance of the errors of state and clock: of unit directions, (16, 16)."""
    H = np.vstack([np.eye(DIMENSION), np.zeros(DIMENSION)])
    return kalman.predicted(H, np.eye(DIMENSION + 1)[-1])


def differs(a: InertialState, b: InertialState) -> Float:
    """Return the error that takes a to b, shape (15,), in the order of the state's slices."""
    d = np.zeros(DIMENSION)
    d[ROTATION] = log_so3(a.R_map_imu.T @ b.R_map_imu)
    d[VELOCITY], d[POSITION] = b.v_map_imu - a.v_map_imu, b.p_map_imu - a.p_map_imu
    return d


def fix(stamp_s: float, p: Float) -> Fix:
    return Fix(stamp_s, "left", ARM, p, 0.02**2 * np.eye(3))


def test_the_derivatives_of_a_fix_are_its_differences() -> None:
    kalman = with_clock()
    kalman.covariance = 1e-6 * kalman.covariance  # so that a turn bends nothing
    residual, H, by_clock, noise = fix_residual(kalman, fix(3.02, np.zeros(3)), 0.02)
    before, step = kalman.state, 1e-6
    for i in range(DIMENSION):
        kalman.state = retract(before, step * np.eye(DIMENSION)[i])
        moved = fix_residual(kalman, fix(3.02, np.zeros(3)), 0.02)[0]
        assert (residual - moved) / step == pytest.approx(H[:, i], abs=1e-4)
    kalman.state = before
    kalman.clock_s += 0.01
    later = fix_residual(kalman, fix(3.02, np.zeros(3)), 0.02)[0]
    assert (residual - later) / 0.01 == pytest.approx(by_clock)
    # By a later clock, the antenna was measured where it had been: back along its velocity.
    turning = np.cross(before.rate, ARM)
    back = -(before.v_map_imu + before.R_map_imu @ turning)
    assert by_clock == pytest.approx(back, rel=0.01)
    force = before.R_map_imu @ (before.sample.force - before.accel_bias)
    bend_m = 0.5 * CLOCK_S**2 * np.linalg.norm(force - [0.0, 0.0, NOISE.gravity_m_s2])
    assert noise == pytest.approx((0.02**2 + bend_m**2) * np.eye(3))


def test_a_known_clock_has_no_part_in_a_fix() -> None:
    known = 1e-6 * covariance(DIMENSION)  # so that a turn bends nothing
    kalman = ErrorStateFilter(state(), known, NOISE, ClockOffset(0.02))
    residual, _, by_clock, noise = fix_residual(kalman, fix(3.02, np.ones(3)), 0.0)
    expected = np.ones(3) - (kalman.state.p_map_imu + kalman.state.R_map_imu @ ARM)
    assert residual == pytest.approx(expected)
    assert by_clock is None
    assert noise == pytest.approx(0.02**2 * np.eye(3))
    assert (kalman.clock_s, kalman.clock_std_s) == (0.02, 0.0)


def test_a_correction_is_the_conditional_of_state_and_clock() -> None:
    kalman = with_clock()
    P, before = joint(kalman), kalman.state
    # A measurement of the attitude alone leaves the acceleration that the clock sees as it was.
    H = np.zeros((3, DIMENSION))
    H[:, POSITION] = np.eye(3)
    by_clock, noise = np.array([1e-3, 2e-3, -1e-3]), 1e-2 * np.eye(3)
    residual = np.array([1e-4, -2e-4, 1e-4])
    full = np.c_[H, by_clock]
    S = full @ P @ full.T + noise
    assert kalman.predicted(H, by_clock) == pytest.approx(S - noise)
    error = P @ full.T @ np.linalg.solve(S, residual)
    assert kalman.correct(residual, H, noise, 60.0, by_clock)
    assert differs(before, kalman.state)[:9] == pytest.approx(error[:9], rel=1e-3, abs=1e-9)
    assert kalman.clock_s - 0.02 == pytest.approx(error[-1])
    left = P - P @ full.T @ np.linalg.solve(S, full @ P)
    assert joint(kalman) == pytest.approx(left, rel=0.05, abs=0.01 * np.abs(left).max())
    assert kalman.clock_std_s == pytest.approx(np.sqrt(left[-1, -1]))


def test_what_is_outside_the_gate_changes_nothing() -> None:
    kalman = with_clock()
    before, P = kalman.state, joint(kalman)
    H = np.eye(3, DIMENSION)
    S = kalman.predicted(H) + 1e-4 * np.eye(3)
    residual = np.linalg.cholesky(S) @ np.array([3.0, 0.0, 0.0])  # a squared distance of 9
    assert not kalman.correct(residual, H, 1e-4 * np.eye(3), 8.9)
    assert kalman.state is before
    assert np.array_equal(joint(kalman), P)
    assert kalman.correct(residual, H, 1e-4 * np.eye(3), 9.1)


def test_a_prediction_carries_the_errors_as_the_motion_does() -> None:
    kalman = with_clock()
    P, dt, step = joint(kalman), 0.01, 1e-6
    sample = Inertial(3.0 + dt, state().sample.rate, state().sample.force, dt)

    def after(start: InertialState) -> InertialState:
        other = ErrorStateFilter(start, np.zeros((DIMENSION, DIMENSION)), NOISE)
        other.predict(sample)
        return other.state

    centre = after(state())
    F = np.zeros((9, DIMENSION))
    for i in range(DIMENSION):
        moved = after(retract(state(), step * np.eye(DIMENSION)[i]))
        F[:, i] = differs(centre, moved)[:9] / step
    kalman.predict(sample)
    assert joint(kalman)[:9, -1] == pytest.approx(F @ P[:DIMENSION, -1], rel=1e-2, abs=2e-6)
    expected = F @ P[:DIMENSION, :DIMENSION] @ F.T
    grown = joint(kalman)[:9, :9] - expected
    assert np.abs(grown).max() < 1e-2 * np.abs(expected).max()
    # Two quartzes differ by 100 ppm.
    assert kalman.clock_std_s**2 == pytest.approx(CLOCK_S**2 + dt * 1e-8, rel=1e-12)


def test_an_old_sample_is_left_alone() -> None:
    kalman = with_clock()
    before, P = kalman.state, joint(kalman)
    kalman.predict(Inertial(3.0, np.ones(3), np.ones(3), 0.01))
    assert kalman.state is before
    assert np.array_equal(joint(kalman), P)


def test_over_a_gap_the_body_goes_on_evenly_and_is_less_certain() -> None:
    kalman, other = with_clock(), with_clock()
    speed = kalman.state.v_map_imu
    kalman.predict(Inertial(3.4, np.ones(3), np.full(3, 5.0), 0.4))
    assert kalman.state.v_map_imu == pytest.approx(speed)
    assert kalman.state.p_map_imu == pytest.approx(state().p_map_imu + 0.4 * speed)
    assert kalman.state.R_map_imu == pytest.approx(state().R_map_imu)
    other.predict(Inertial(3.4, np.ones(3), np.full(3, 5.0), 0.09))
    more = np.diag(kalman.covariance) - np.diag(other.covariance)
    usual = kalman._usual  # what the body usually does decides by how much
    velocity_m_s = 0.4 * usual.acceleration_m_s2
    assert more[VELOCITY] == pytest.approx(velocity_m_s**2)
    assert more[POSITION] == pytest.approx((0.5 * 0.4 * velocity_m_s) ** 2)
    assert more[ROTATION] == pytest.approx((0.4 * usual.rate_rad_s) ** 2)


def test_a_faded_state_keeps_its_correlation_with_the_clock() -> None:
    kalman = with_clock()
    P = joint(kalman)
    kalman.fade(4.0)
    scale = np.r_[np.full(DIMENSION, 2.0), 1.0]
    assert joint(kalman) == pytest.approx(np.outer(scale, scale) * P)


def test_variance_is_added_where_it_is_said() -> None:
    kalman = with_clock()
    before = kalman.covariance  # what was given out is left as it is
    kalman.inflate(0.1, 0.2, 0.3)
    added = np.zeros(DIMENSION)
    added[POSITION], added[VELOCITY], added[ROTATION] = 0.01, 0.04, 0.09
    assert kalman.covariance - before == pytest.approx(np.diag(added))
