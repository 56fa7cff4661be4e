"""A filter that is given its first state: the clock that it assumes, and what it refuses."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.kalman.agreeing_clock import AgreeingClock
from executive_plugins.estimation.start.found import Found

from executive.messages.gnss import GnssFix

DATUM = np.array([47.4, 8.5, 440.0])
Z = np.zeros(3)


def found() -> Found:
    state = InertialState(Inertial(1.0, Z, np.array([0.0, 0.0, 9.81]), 0.01), np.eye(3), Z, Z, Z, Z)
    return Found(state, 1e-4 * np.eye(15), True, ClockOffset(0.0, 0.05))


@pytest.mark.parametrize(
    ("clock_agrees", "clock_std_s", "expected"),
    [
        (0.5, 0.05, AgreeingClock(0.5, 0.05)),
        (0.2, 1.0, AgreeingClock(0.2, 1.0)),
        (0.0, 0.05, None),
        (0.5, 0.0, None),  # clocks that agree for certain are not estimated
    ],
)
def test_a_clock_may_agree_where_it_is_estimated(
    start, clock_agrees: float, clock_std_s: float, expected: AgreeingClock | None
) -> None:
    estimator = start(clock_agrees=clock_agrees, clock_std_s=clock_std_s)
    estimator._start_at(found())
    assert estimator._trailing.kalman.agreeing_clock == expected


@pytest.mark.parametrize(("std_m", "is_used"), [(0.99, True), (1.01, False)])
def test_a_fix_that_is_too_uncertain_is_counted_and_gives_no_origin(
    start, std_m: float, is_used: bool
) -> None:
    """The largest of its deviations counts."""
    estimator = start(datum=None, max_gnss_std_m=1.0, gnss_scale=1.0)
    covariance = np.diag([1e-4, std_m**2, 1e-4])
    estimator.add_gnss(GnssFix(1.0, "gnss_left", DATUM, covariance, False))
    assert estimator.refused == ({} if is_used else {"gnss_left: too uncertain": 1})
    assert list(estimator.keep()) == (["datum"] if is_used else [])


def test_a_fix_without_an_uncertainty_is_too_good_to_be_used(start) -> None:
    estimator = start(datum=None)
    estimator.add_gnss(GnssFix(1.0, "gnss_left", DATUM, np.zeros((3, 3)), False))
    assert estimator.refused == {"gnss_left: too uncertain": 1}


def test_a_fix_of_an_unknown_antenna_is_counted(start) -> None:
    estimator = start(datum=None)
    estimator.add_gnss(GnssFix(1.0, "gnss_mast", DATUM, 1e-4 * np.eye(3), False))
    assert estimator.refused == {"gnss_mast: unknown antenna": 1}
    assert estimator.keep() == {}


def test_a_filter_that_begins_anew_keeps_the_clock_that_it_was_begun_with(start) -> None:
    """What an earlier filter knew of the clock does not belong to the state of the new one."""
    estimator = start(clock_agrees=0.0, clock_std_s=0.05)
    estimator._start_at(found())
    estimator._fixes.clock.remember(1.0, -0.3)
    estimator._fixes.clock.hold(estimator._trailing.kalman, 0.0)
    assert estimator._trailing.kalman.clock_s == -0.3
    estimator._start_at(found())
    estimator._fixes.clock.hold(estimator._trailing.kalman, 0.0)
    assert estimator._trailing.kalman.clock_s == 0.0
    assert estimator._trailing.kalman.clock_std_s == pytest.approx(0.05)
