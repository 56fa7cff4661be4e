"""Corrections that turn velocity and position along, against the exponential and by chance."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.exponential import linear_covariance, moved
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
    propagate,
)
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import fix_residual
from scipy.linalg import expm, logm
from scipy.stats import chi2

from executive.arrays import Float
from executive.geometry.rotation import exp_so3, skew

ARM_M = np.array([0.4, 1.0, 0.6])
WEIGHT = np.array([0.0, 0.0, 9.81])


def some_state() -> InertialState:
    rng = np.random.default_rng(5)
    sample = Inertial(1.0, np.array([0.1, -0.2, 0.7]), np.array([0.5, -1.0, 9.5]))
    R = exp_so3(rng.normal(0, 1, 3))
    return InertialState(sample, R, *rng.normal(0, 1, (2, 3)), *rng.normal(0, 0.05, (2, 3)))


def as_group(state: InertialState) -> Float:
    """The extended pose, shape (5, 5)."""
    X = np.eye(5)
    X[:3, :3], X[:3, 3], X[:3, 4] = state.R_map_imu, state.v_map_imu, state.p_map_imu
    return X


def algebra(state: InertialState, error: Float) -> Float:
    """The error in axes of the body, shape (5, 5)."""
    E = np.zeros((5, 5))
    E[:3, :3] = skew(error[ROTATION])
    E[:3, 3] = state.R_map_imu.T @ error[VELOCITY]
    E[:3, 4] = state.R_map_imu.T @ error[POSITION]
    return E


def left(state: InertialState, true: Float) -> Float:
    """The error of a state whose true extended pose is given, shape (9,)."""
    E = np.real(logm(np.linalg.inv(as_group(state)) @ true))
    rotation = np.array([E[2, 1], E[0, 2], E[1, 0]])
    R = state.R_map_imu
    return np.concatenate([rotation, R @ E[:3, 3], R @ E[:3, 4]])


def test_a_correction_is_the_exponential_of_the_group() -> None:
    state = some_state()
    for size in (1e-7, 0.05, 1.0):
        error = size * np.random.default_rng(6).normal(0, 1, 15)
        expected = as_group(state) @ expm(algebra(state, error))
        np.testing.assert_allclose(as_group(moved(state, error)[0]), expected, atol=1e-9)


def test_what_is_left_of_an_error_follows_its_derivative() -> None:
    state, step = some_state(), 1e-6
    error = 0.2 * np.random.default_rng(7).normal(0, 1, 15)
    after, J = moved(state, error)
    for i in range(9):
        true = error + step * np.eye(15)[i]
        rest = left(after, as_group(state) @ expm(algebra(state, true)))
        # The derivative by the rotation is of second order: 0.3³ of what it multiplies, 0.3.
        np.testing.assert_allclose(rest / step, J[:9, i], atol=3e-3)
    np.testing.assert_array_equal(J[9:, 9:], np.eye(6))


def test_a_turn_keeps_a_well_measured_antenna_in_its_place() -> None:
    state, theta = some_state(), np.array([0.05, -0.1, 0.8])
    error = np.zeros(15)
    error[ROTATION] = theta
    error[POSITION] = -state.R_map_imu @ np.cross(theta, ARM_M)  # as the covariance couples them
    after = moved(state, error)[0]
    np.testing.assert_allclose(
        after.p_map_imu + after.R_map_imu @ ARM_M,
        state.p_map_imu + state.R_map_imu @ ARM_M,
        atol=1e-12,
    )


def test_the_linear_covariance_is_that_of_drawn_errors() -> None:
    state, rng = some_state(), np.random.default_rng(8)
    root = np.zeros((15, 15))
    root[:9, :9] = 0.1 * rng.normal(0, 1, (9, 9))
    P = root @ root.T
    # A direction in which the linear terms cancel: the antenna is known, the heading is not.
    known = np.zeros((3, 15))
    known[:, ROTATION], known[:, POSITION] = -state.R_map_imu @ skew(ARM_M), np.eye(3)
    K = P @ known.T @ np.linalg.inv(known @ P @ known.T + 1e-8 * np.eye(3))
    P = (np.eye(15) - K @ known) @ P
    drawn = rng.multivariate_normal(np.zeros(15), P, 20_000)
    p = np.array([moved(state, error)[0].p_map_imu for error in drawn]) - state.p_map_imu
    found = linear_covariance(state, P)[POSITION, POSITION]
    np.testing.assert_allclose(found, p.T @ p / len(p), rtol=0.05, atol=0.03 * np.trace(found))
    thinnest = np.linalg.eigh(P[POSITION, POSITION])[1][:, 0]
    assert thinnest @ found @ thinnest > 1.2 * thinnest @ P[POSITION, POSITION] @ thinnest


def _distance2(seed: int) -> float:
    """Return the squared error of a heading of 0.3 rad at first, after 3 s of fixes of 1 cm."""
    rng, dt_s, noise = np.random.default_rng(seed), 0.01, (1e-3, 1e-2)
    sheet = InertialNoise(*noise, 1e-6, 1e-5, 1e-3, 9.81, 1e-4)
    still = Inertial(0.0, np.zeros(3), WEIGHT)
    zeros = np.zeros(3)
    guess = InertialState(still, np.eye(3), zeros, np.array([2.0, 0.0, 0.0]), zeros, zeros)
    P = np.diag(np.repeat([0.02, 0.3, 0.02, 1e-5, 1e-4], 3) ** 2)
    P[2, 2] = 0.3**2
    around = np.eye(15)  # a start knows the antenna, and its carrier on a circle about it
    around[POSITION, ROTATION] = skew(ARM_M)
    P = around @ P @ around.T
    true = moved(guess, rng.multivariate_normal(np.zeros(15), P))[0]
    kalman = ErrorStateFilter(guess, P, sheet)
    for i in range(1, 301):
        at_s = i * dt_s
        rate = np.array([0.0, 0.0, 0.5 * np.sin(2 * at_s)])
        force = np.array([1.5 * np.sin(3 * at_s), np.cos(4 * at_s), 9.81])
        true = propagate(true, Inertial(at_s, rate, force, dt_s), 9.81)
        errors = rng.normal(0, 1, (2, 3)) * np.array(noise)[:, None] / np.sqrt(dt_s)
        kalman.predict(Inertial(at_s, rate + errors[0], force + errors[1], dt_s))
        if i % 5 == 0:
            p = true.p_map_imu + true.R_map_imu @ ARM_M + rng.normal(0, 0.01, 3)
            fix = Fix(at_s, "antenna", ARM_M, p, 0.01**2 * np.eye(3))
            residual, H, _, variance = fix_residual(kalman, fix, 0.0)
            kalman.correct(residual, H, variance, np.inf)
    error = left(kalman.state, as_group(true))
    return float(error @ np.linalg.solve(kalman.covariance[:9, :9], error))


def test_a_heading_that_errs_by_a_quarter_of_a_radian_leaves_the_filter_consistent() -> None:
    squares = [_distance2(seed) for seed in range(20)]
    assert chi2.ppf(0.005, 9 * 20) < np.sum(squares) < chi2.ppf(0.995, 9 * 20)


def test_the_series_of_a_small_turn_joins_the_closed_form() -> None:
    state, error = some_state(), np.zeros(15)
    error[POSITION] = [1.0, 2.0, 3.0]
    for angle in (0.9e-5, 1.1e-5):
        error[ROTATION] = angle * np.array([0.6, -0.48, 0.64])
        turned = moved(state, error)[0].p_map_imu - state.p_map_imu - error[POSITION]
        axis = state.R_map_imu @ error[ROTATION]
        assert turned == pytest.approx(0.5 * np.cross(axis, error[POSITION]), rel=1e-4)
