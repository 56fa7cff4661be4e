"""The compiled equations against the same in matrices, for arrays of any layout."""

import numpy as np
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    Inertial,
    InertialState,
    carry_covariance,
    error_transition,
    propagate,
    propagate_through,
    stepped,
)

from executive.geometry.rotation import exp_so3

NOISE = InertialNoise(2e-3, 3e-2, 4e-4, 5e-3, 0.1, 9.81, 0.01)
STEP_S = 0.03


def some_state() -> InertialState:
    rng = np.random.default_rng(4)
    sample = Inertial(1.0, np.array([0.1, -0.2, 0.7]), np.array([0.5, -1.0, 9.5]))
    R = exp_so3(rng.normal(0, 1, 3))
    return InertialState(sample, R, *rng.normal(0, 1, (2, 3)), *rng.normal(0, 0.05, (2, 3)))


def test_covariance_is_carried_by_the_transition_of_errors() -> None:
    state, rng = some_state(), np.random.default_rng(5)
    root = rng.normal(0, 0.1, (15, 15))
    F = error_transition(state, STEP_S)
    white = np.repeat([2e-3**2, 3e-2**2, 3e-2**2 * STEP_S**2 / 3, 4e-4**2, 5e-3**2], 3) * STEP_S
    expected = F @ root @ root.T @ F.T + np.diag(white)
    np.testing.assert_allclose(
        carry_covariance(state, root @ root.T, NOISE, STEP_S), expected, rtol=1e-9, atol=1e-12
    )


def test_the_cross_covariance_is_propagated_by_the_same_transition() -> None:
    state, cross = some_state(), np.random.default_rng(7).normal(0, 0.1, (15, 6))
    expected = error_transition(state, STEP_S) @ cross
    sample = Inertial(1.0 + STEP_S, *np.random.default_rng(9).normal(0, 1, (2, 3)))
    _, _, crossed = stepped(state, np.eye(15), cross, sample, NOISE)
    np.testing.assert_allclose(crossed, expected, rtol=1e-9, atol=1e-12)


def test_a_step_is_that_of_the_state_and_that_of_its_covariance() -> None:
    """The covariance is carried by the sample before, and the state by the next one."""
    state, rng = some_state(), np.random.default_rng(6)
    root, sample = rng.normal(0, 0.1, (15, 15)), Inertial(1.03, *rng.normal(0, 1, (2, 3)))
    after, covariance, none = stepped(state, root @ root.T, np.empty((15, 0)), sample, NOISE)
    assert after.sample is sample
    assert none.shape == (15, 0)
    for a, b in zip(numbers(after), numbers(propagate(state, sample, 9.81)), strict=True):
        np.testing.assert_array_equal(a, b)
    dt_s = sample.stamp_s - state.stamp_s
    same = carry_covariance(state, root @ root.T, NOISE, dt_s)
    np.testing.assert_allclose(covariance, same, rtol=1e-13, atol=1e-18)


def test_propagation_through_samples_equals_single_steps() -> None:
    state, rng = some_state(), np.random.default_rng(8)
    samples = [Inertial(1.0 + k / 100, *rng.normal(0, 1, (2, 3))) for k in range(1, 6)]
    one_by_one = state
    for sample in samples:
        one_by_one = propagate(one_by_one, sample, 9.81)
    at_once = propagate_through(state, samples, 9.81)
    assert at_once.sample is samples[-1]
    for a, b in zip(numbers(at_once), numbers(one_by_one), strict=True):
        np.testing.assert_array_equal(a, b)
    assert propagate_through(state, (), 9.81).sample is state.sample


def test_read_only_and_transposed_arrays_give_the_same() -> None:
    state = some_state()
    locked = state.sample.rate.copy()
    locked.flags.writeable = False
    turned = InertialState(state.sample, np.asfortranarray(state.R_map_imu), *positions(state))
    sample = Inertial(1.01, locked, state.sample.force)
    for a, b in zip(
        numbers(propagate(state, sample, 9.81)),
        numbers(propagate(turned, sample, 9.81)),
        strict=True,
    ):
        np.testing.assert_array_equal(a, b)


def positions(state: InertialState) -> tuple[np.ndarray, ...]:
    return state.p_map_imu, state.v_map_imu, state.gyro_bias, state.accel_bias


def numbers(state: InertialState) -> tuple[np.ndarray, ...]:
    return (state.R_map_imu, *positions(state))
