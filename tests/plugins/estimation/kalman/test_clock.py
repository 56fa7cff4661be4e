"""What a filter believes of a receiver's clock that it estimates."""

import numpy as np
import pytest
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
_TURN_DENSITIES = 1e-3, 3e-3  # angular random walks [rad/√s]
_ARM_M = np.array([1.0, 0.0, 1.5])
_WEIGHT = np.array([0.0, 0.0, 9.81])
_RATE_HZ, _FIX_STD_M = 100.0, 0.016


def _started(speed_m_s: Float, turn_density: float) -> ErrorStateFilter:
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
    noise = InertialNoise(turn_density, 2 * _DENSITY, 1e-5, 1e-4, 0.03, 9.81, 1e-3)
    return ErrorStateFilter(start, covariance, noise, ClockOffset(0.0, _CLOCK_S, cross))


def _after(speed_m_s: Float, turn_density: float, seed: int) -> ErrorStateFilter:
    """Return the filter after 20 s at constant velocity with a clock that agrees."""
    kalman, rng = _started(speed_m_s, turn_density), np.random.default_rng(seed)
    for i in range(1, int(20 * _RATE_HZ) + 1):
        at_s = i / _RATE_HZ
        shaken = rng.normal(0.0, _DENSITY * np.sqrt(_RATE_HZ), 3)
        turned = rng.normal(0.0, turn_density * np.sqrt(_RATE_HZ), 3)
        kalman.predict(Inertial(at_s, turned, _WEIGHT + shaken, 1 / _RATE_HZ))
        if i % 5 == 0:
            p = speed_m_s * at_s + _ARM_M + rng.normal(0.0, _FIX_STD_M, 3)
            fix = Fix(at_s, "antenna", _ARM_M, p, _FIX_STD_M**2 * np.eye(3))
            residual, H, by_clock, noise = fix_residual(kalman, fix, 0.0)
            assert kalman.correct(residual, H, noise, 60.0, by_clock)
    return kalman


@pytest.mark.parametrize("turn_density", _TURN_DENSITIES)
def test_noise_of_the_velocity_does_not_tell_of_the_clock(turn_density: float) -> None:
    # Even motion tells nothing of a clock.
    filters = [_after(_SPEED_M_S, turn_density, seed) for seed in range(6)]
    squares = [(kalman.clock_s / kalman.clock_std_s) ** 2 for kalman in filters]
    assert np.sum(squares) < chi2.ppf(0.99, len(filters))
    assert all(kalman.clock_std_s > 0.4 * _CLOCK_S for kalman in filters)


@pytest.mark.parametrize("turn_density", _TURN_DENSITIES)
def test_noise_at_rest_does_not_tell_of_the_clock(turn_density: float) -> None:
    filters = [_after(np.zeros(3), turn_density, seed) for seed in range(3)]
    assert all(kalman.clock_std_s > 0.7 * _CLOCK_S for kalman in filters)


@pytest.mark.parametrize("turns_rad_s", [0.0, 0.5])
def test_a_turn_moves_the_antenna_by_the_newest_rate(turns_rad_s: float) -> None:
    kalman, rng = _started(_SPEED_M_S, 3e-3), np.random.default_rng(1)
    turn = np.array([0.0, turns_rad_s, 0.0])
    for i in range(200):  # the turn begins after 1.6 s
        noise = rng.normal(0.0, 3e-3 * np.sqrt(_RATE_HZ), 3)
        kalman.predict(Inertial((i + 1) / _RATE_HZ, noise + turn * (i >= 160), _WEIGHT, 0.01))
    kalman.covariance = 1e-6 * kalman.covariance  # a velocity counts less what its own error is
    fix = Fix(2.0, "antenna", _ARM_M, np.zeros(3), _FIX_STD_M**2 * np.eye(3))
    _, _, by_clock, _ = fix_residual(kalman, fix, 0.0)
    state = kalman.state
    expected = -(state.v_map_imu + state.R_map_imu @ np.cross(turn, _ARM_M))
    # A mean over 0.1 s errs by 5 cm/s, one over a second by 1, and is 0.3 m/s behind the turn.
    assert by_clock == pytest.approx(expected, abs=0.08 if turns_rad_s else 0.02)


def test_clocks_agree_unless_something_else_is_known() -> None:
    agreed = ClockOffset()
    assert (agreed.offset_s, agreed.std_s) == (0.0, 0.0)
    assert not agreed.cross.any()
