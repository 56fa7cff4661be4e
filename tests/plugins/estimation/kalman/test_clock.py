"""What a filter believes of a receiver's clock that it estimates."""

import numpy as np
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import POSITION, Inertial, InertialState
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import fix_residual
from scipy.stats import chi2

from executive.arrays import Float

_SPEED_M_S = np.array([10.0, 0.0, 0.0])
_CLOCK_S, _DENSITY = 0.1, 0.023  # velocity random walk [m/s/√s] of a cheap sensor that shakes
_TURN_DENSITY = 1e-3  # angular random walk [rad/√s]
_ARM_M = np.array([1.0, 0.0, 1.5])
_WEIGHT = np.array([0.0, 0.0, 9.81])
_RATE_HZ, _FIX_STD_M = 100.0, 0.016


def _started(speed_m_s: Float) -> ErrorStateFilter:
    """Return a filter whose position errs by the speed times the clock's unknown offset."""
    start = InertialState(
        Inertial(0.0, np.zeros(3), _WEIGHT),
        np.eye(3),
        np.zeros(3),
        speed_m_s,
        np.zeros(3),
        np.zeros(3),
    )
    variances = np.repeat([0.02, 0.1, 0.05, 1e-3, 0.03], 3) ** 2
    covariance, cross = np.diag(variances), np.zeros(15)
    cross[POSITION] = speed_m_s * _CLOCK_S**2
    covariance[POSITION, POSITION] += np.outer(speed_m_s, speed_m_s) * _CLOCK_S**2
    noise = InertialNoise(_TURN_DENSITY, 2 * _DENSITY, 1e-5, 1e-4, 0.03, 9.81, 1e-3)
    return ErrorStateFilter(start, covariance, noise, ClockOffset(0.0, _CLOCK_S, cross))


def _after(speed_m_s: Float, seed: int) -> ErrorStateFilter:
    """Return the filter after 20 s at constant velocity with a clock that agrees."""
    kalman, rng = _started(speed_m_s), np.random.default_rng(seed)
    for i in range(1, int(20 * _RATE_HZ) + 1):
        at_s = i / _RATE_HZ
        shaken = rng.normal(0.0, _DENSITY * np.sqrt(_RATE_HZ), 3)
        turned = rng.normal(0.0, _TURN_DENSITY * np.sqrt(_RATE_HZ), 3)
        kalman.predict(Inertial(at_s, turned, _WEIGHT + shaken, 1 / _RATE_HZ))
        if i % 5 == 0:
            p = speed_m_s * at_s + _ARM_M + rng.normal(0.0, _FIX_STD_M, 3)
            fix = Fix(at_s, "antenna", _ARM_M, p, _FIX_STD_M**2 * np.eye(3))
            residual, H, by_clock, noise = fix_residual(kalman, fix, 0.0)
            assert kalman.correct(residual, H, noise, 60.0, by_clock)
    return kalman


def test_noise_of_the_velocity_does_not_tell_of_the_clock() -> None:
    # Even motion tells nothing of a clock.
    filters = [_after(_SPEED_M_S, seed) for seed in range(6)]
    squares = [(kalman.clock_s / kalman.clock_std_s) ** 2 for kalman in filters]
    assert np.sum(squares) < chi2.ppf(0.99, len(filters))
    assert all(kalman.clock_std_s > 0.4 * _CLOCK_S for kalman in filters)


def test_noise_at_rest_does_not_tell_of_the_clock() -> None:
    assert all(_after(np.zeros(3), seed).clock_std_s > 0.7 * _CLOCK_S for seed in range(3))


def test_clocks_agree_unless_something_else_is_known() -> None:
    agreed = ClockOffset()
    assert (agreed.offset_s, agreed.std_s) == (0.0, 0.0)
    assert not agreed.cross.any()
