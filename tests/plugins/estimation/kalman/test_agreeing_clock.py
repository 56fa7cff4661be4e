"""A clock that may agree: two hypotheses in one filter."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.exponential import linear_covariance, moved
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import POSITION, Inertial, InertialState
from executive_plugins.estimation.kalman.agreeing_clock import AgreeingClock
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter

PRIOR_S, NOISE_S = 0.1, 0.02
CLOCK = AgreeingClock(0.5, PRIOR_S)


def measured(z_s: float) -> tuple[float, float]:
    """Return offset and deviation by one measurement of a clock that is off."""
    weight = PRIOR_S**2 / (PRIOR_S**2 + NOISE_S**2)
    return weight * z_s, float(np.sqrt(weight)) * NOISE_S


@pytest.mark.parametrize("z_s", [0.0, 0.03, -0.06])
def test_the_ratio_of_densities_is_that_of_the_likelihoods(z_s: float) -> None:
    agrees = np.exp(-0.5 * (z_s / NOISE_S) ** 2) / NOISE_S
    wide = np.hypot(PRIOR_S, NOISE_S)
    is_off = np.exp(-0.5 * (z_s / wide) ** 2) / wide
    for before in (0.5, 0.8):
        expected = before * agrees / (before * agrees + (1 - before) * is_off)
        clock = AgreeingClock(before, PRIOR_S)
        assert clock.probability_after(*measured(z_s)) == pytest.approx(expected, rel=1e-12)


def test_before_a_measurement_nothing_is_changed_in_the_odds() -> None:
    assert AgreeingClock(0.3, PRIOR_S).probability_after(0.0, PRIOR_S) == pytest.approx(0.3)


def test_the_mixture_has_the_moments_of_its_parts() -> None:
    A = np.random.default_rng(2).normal(size=(4, 8))
    joint = 1e-4 * A @ A.T
    P, cross, std_s, offset_s = joint[:3, :3], joint[:3, 3], float(np.sqrt(joint[3, 3])), 0.013
    share, gain = CLOCK.probability_after(offset_s, std_s), joint[:3, 3] / std_s**2
    agreeing = -offset_s * gain  # the error's mean if the clock agrees, else zero
    mean, covariance = CLOCK.mixed(P, cross, offset_s, std_s)
    np.testing.assert_allclose(mean, share * agreeing)
    second = share * (P - std_s**2 * np.outer(gain, gain) + np.outer(agreeing, agreeing))
    second += (1 - share) * P
    np.testing.assert_allclose(covariance, second - np.outer(mean, mean))
    assert np.linalg.eigvalsh(covariance)[0] > 0


def test_a_filter_reports_the_mixture_and_goes_on_as_before() -> None:
    zero, weight = np.zeros(3), np.array([0.0, 0.0, 9.81])
    speed, std_s, late_s = np.array([10.0, 0.0, 0.0]), 0.01, 0.005
    state = InertialState(Inertial(0.0, zero, weight), np.eye(3), zero, speed, zero, zero)
    P, cross = 1e-4 * np.eye(15), np.zeros(15)
    cross[POSITION] = speed * std_s**2
    P[POSITION, POSITION] += std_s**2 * np.outer(speed, speed)
    noise = InertialNoise(1e-3, 1e-2, 1e-5, 1e-4, 0.03, 9.81, 1e-3)
    kalman = ErrorStateFilter(state, P, noise, ClockOffset(late_s, std_s, cross))
    alone = kalman.reported()
    assert alone[0] is state
    np.testing.assert_allclose(alone[1], linear_covariance(state, P))
    kalman.agreeing_clock = CLOCK
    reported, covariance = kalman.reported()
    error, mixed = CLOCK.mixed(P, cross, late_s, std_s)
    expected, J = moved(state, error)
    np.testing.assert_allclose(reported.p_map_imu, expected.p_map_imu)
    np.testing.assert_allclose(covariance, linear_covariance(expected, J @ mixed @ J.T))
    assert reported.p_map_imu[0] < -0.8 * late_s * speed[0]
    assert covariance[6, 6] < alone[1][6, 6]
    assert kalman.state is state
    np.testing.assert_array_equal(kalman.covariance, P)
