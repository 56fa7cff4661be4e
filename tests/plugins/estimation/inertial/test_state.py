"""The strapdown equations against finite differences and known motions."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.measurement_models import (
    antenna_residual,
    standstill_residual,
)
from executive_plugins.estimation.inertial.state import (
    ACCEL_BIAS,
    DIMENSION,
    GYRO_BIAS,
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
    error_transition,
    propagate,
    retract,
    rotation_step,
)

from executive.geometry.rotation import exp_so3, log_so3, skew

GRAVITY = 9.81


def some_state() -> InertialState:
    rng = np.random.default_rng(0)
    sample = Inertial(1.0, np.array([0.1, -0.2, 0.7]), np.array([0.5, -1.0, 9.5]))
    R = exp_so3(rng.normal(0, 1, 3))
    return InertialState(sample, R, *rng.normal(0, 1, (2, 3)), *rng.normal(0, 0.05, (2, 3)))


def difference(a: InertialState, b: InertialState) -> np.ndarray:
    """The error that turns a into b."""
    return np.concatenate(
        [
            log_so3(a.R_map_imu.T @ b.R_map_imu),
            b.v_map_imu - a.v_map_imu,
            b.p_map_imu - a.p_map_imu,
            b.gyro_bias - a.gyro_bias,
            b.accel_bias - a.accel_bias,
        ]
    )


def test_rotation_step_is_the_exponential_for_small_and_large_angles() -> None:
    for angle in (0.0, 1e-9, 1e-6, 1e-4, 1e-2, 1.0, 3.0):
        vector = angle * np.array([0.6, -0.48, 0.64])
        np.testing.assert_allclose(rotation_step(vector), exp_so3(vector), atol=1e-11)
    np.testing.assert_array_equal(
        skew(np.array([1.0, 2.0, 3.0])) @ [4.0, 5.0, 6.0], np.cross([1, 2, 3], [4, 5, 6])
    )


def test_a_falling_sensor_feels_nothing_and_falls() -> None:
    still = Inertial(0.0, np.zeros(3), np.zeros(3))
    state = InertialState(still, np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3))
    for k in range(1, 101):
        state = propagate(state, Inertial(k / 100, np.zeros(3), np.zeros(3)), GRAVITY)
    np.testing.assert_allclose(state.p_map_imu, [0, 0, -GRAVITY / 2], atol=1e-12)
    np.testing.assert_allclose(state.v_map_imu, [0, 0, -GRAVITY], atol=1e-12)


def test_a_step_may_be_split_where_a_correction_falls() -> None:
    sample = Inertial(1.01, np.array([0.2, 0.1, 0.8]), np.array([0.3, 0.2, 9.8]))
    state = some_state()
    whole = propagate(state, sample, GRAVITY)
    halves = propagate(propagate(state, sample.until(1.004), GRAVITY), sample, GRAVITY)
    assert np.abs(difference(whole, halves)).max() < 1e-6  # second order in the step


def test_transition_agrees_with_finite_differences() -> None:
    state, dt, h = some_state(), 0.01, 1e-6
    sample = Inertial(1.0 + dt, state.sample.rate, state.sample.force)
    after = propagate(state, sample, GRAVITY)
    columns = []
    for i in range(DIMENSION):
        error = np.zeros(DIMENSION)
        error[i] = h
        columns.append(difference(after, propagate(retract(state, error), sample, GRAVITY)) / h)
    # To first order in a step of 10 ms at 0.8 rad/s and 10 m/s²: what is left is of second order.
    np.testing.assert_allclose(error_transition(state, dt), np.array(columns).T, atol=1e-3)


@pytest.mark.parametrize(
    "residual",
    [
        lambda s: antenna_residual(s, np.array([-1.3, 0.6, 1.2]), np.array([3.0, 2.0, 1.0])),
        lambda s: standstill_residual(s, np.array([0.2, -0.3, -0.4])),
    ],
    ids=["antenna", "standing"],
)
def test_measurement_jacobians_agree_with_finite_differences(residual) -> None:
    state, h = some_state(), 1e-6
    at_state, H = residual(state)
    for i in range(DIMENSION):
        error = np.zeros(DIMENSION)
        error[i] = h
        np.testing.assert_allclose(
            -(residual(retract(state, error))[0] - at_state) / h, H[:, i], atol=1e-5
        )


def test_blocks_cover_the_error_state_once() -> None:
    counts = np.zeros(DIMENSION)
    for block in (ROTATION, VELOCITY, POSITION, GYRO_BIAS, ACCEL_BIAS):
        counts[block] += 1
    assert (counts == 1).all()
