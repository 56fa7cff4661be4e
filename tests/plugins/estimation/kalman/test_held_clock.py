"""What other sensors err does not pass for an offset of the receiver's clock."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.gate.innovation_alarm import chance_limit
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    VELOCITY,
    Inertial,
    InertialState,
)
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.held_clock import HeldClock, shows_clock
from scipy.stats import chi2

Z, UP = np.zeros(3), np.array([0.0, 0.0, 9.81])
NOISE = InertialNoise(1e-3, 1e-2, 1e-6, 1e-5, 1e-2, 9.81, 1e-3)


@pytest.fixture
def kalman() -> ErrorStateFilter:
    state = InertialState(Inertial(0.0, Z, UP, 0.01), np.eye(3), Z, Z, Z, Z)
    return ErrorStateFilter(state, np.eye(DIMENSION), NOISE, ClockOffset(0.0, 0.1, np.zeros(15)))


def at(kalman: ErrorStateFilter, stamp_s: float, clock_s: float) -> ErrorStateFilter:
    """Return a filter at a time, with an estimate of the clock."""
    kalman.state = replace(kalman.state, sample=Inertial(stamp_s, Z, UP, 0.01))
    kalman.clock_s = clock_s
    return kalman


def follow(clock: HeldClock, kalman: ErrorStateFilter) -> None:
    """Do as with a fix that is in no doubt."""
    kalman.holds_clock = clock.is_held(kalman)
    if not kalman.holds_clock:
        clock.remember(kalman.stamp_s, kalman.clock_s)


def test_a_doubt_takes_back_what_was_learnt_since_the_error_began(kalman) -> None:
    clock = HeldClock(10.0)
    for k in range(6):
        follow(clock, at(kalman, float(k), 0.01 * k))
        assert not kalman.holds_clock
    clock.hold(at(kalman, 5.5, 0.06), 2.0)
    assert kalman.holds_clock
    assert kalman.clock_s == pytest.approx(0.03)  # of second 3
    clock.hold(at(kalman, 6.0, 0.03), 2.0)
    assert kalman.clock_s == pytest.approx(0.03)


def test_an_error_that_is_older_than_all_that_is_known_takes_back_the_first(kalman) -> None:
    clock = HeldClock(10.0)
    for k in range(30):
        follow(clock, at(kalman, float(k), 0.01 * k))
    clock.hold(at(kalman, 29.0, 0.3), 100.0)
    assert kalman.clock_s == pytest.approx(0.09)  # of 20 s ago
    HeldClock(10.0).hold(at(kalman, 29.0, 0.3), 1.0)
    assert kalman.clock_s == 0.3  # nothing is known of before


def test_the_clock_is_estimated_again_some_time_after_the_last_doubt(kalman) -> None:
    clock = HeldClock(10.0)
    follow(clock, at(kalman, 0.0, 0.0))
    clock.hold(at(kalman, 1.0, 0.0), 1.0)
    clock.hold(at(kalman, 3.0, 0.0), 1.0)
    for stamp_s, holds in ((3.1, True), (12.9, True), (13.0, False)):
        follow(clock, at(kalman, stamp_s, 0.0))
        assert kalman.holds_clock is holds


def test_after_a_gap_in_the_samples_it_is_held_as_well(kalman) -> None:
    """The heading is uncertain after a gap, and what it errs would tell of the clock."""
    clock = HeldClock(10.0)
    follow(clock, kalman)
    kalman.predict(Inertial(1.0, Z, UP, 1.0))
    follow(clock, kalman)
    assert kalman.holds_clock
    follow(clock, at(kalman, 11.5, 0.0))
    assert not kalman.holds_clock


def moving(v: np.ndarray, rate: np.ndarray, std_m_s: float) -> ErrorStateFilter:
    """Return a filter with an estimated velocity, turned by a quarter about the vertical."""
    R = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    state = InertialState(Inertial(0.0, rate, UP, 0.01), R, Z, v, Z, Z)
    P = np.eye(DIMENSION)
    P[VELOCITY, VELOCITY] *= std_m_s**2
    return ErrorStateFilter(state, P, NOISE, ClockOffset(0.0, 0.1, np.zeros(15)))


ARM = np.array([0.0, 1.0, 0.5])


@pytest.mark.parametrize("axis", range(3))
def test_an_antenna_shows_the_clock_only_if_it_moves_more_than_chance_makes_of_rest(axis) -> None:
    limit = np.sqrt(chance_limit(0.125))
    v = np.eye(3)[axis] * 0.02
    assert not shows_clock(moving(0.95 * limit * v, Z, 0.02), ARM, 0.2)
    assert shows_clock(moving(1.05 * limit * v, Z, 0.02), ARM, 0.2)
    assert not shows_clock(moving(1.05 * limit * v, Z, 0.03), ARM, 0.2)


def test_an_antenna_that_swings_about_the_sensor_shows_the_clock() -> None:
    swing = np.array([0.0, 0.0, 0.5])
    assert shows_clock(moving(Z, swing, 0.02), ARM, 0.2)
    assert not shows_clock(moving(Z, swing, 0.02), np.array([0.0, 0.0, 0.5]), 0.2)


def test_chance_moves_an_antenna_at_rest_once_an_hour() -> None:
    assert chi2.sf(chance_limit(0.125), 3) * 3600 / 0.125 == pytest.approx(1.0)
