"""Fixes that are wrong for seconds: the filter returns to its state of before, and only then."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.filters.status_account import GLOBAL, SUSPECT

from executive.geometry.geodesy import geodetic_from_enu
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.observation import Observation

FROM_S, UNTIL_S, END_S = 8.0, 15.0, 17.0
RETURNS = "went back to the state of before the doubt, with which fixes agree again"


def moved(observations: Iterable[Observation], by_m: Callable[[float], np.ndarray]):
    """Move fixes from `FROM_S` on by what a function of the time since then says [m]."""
    for observation in observations:
        if isinstance(observation, GnssFix) and observation.stamp_s > FROM_S:
            off = by_m(observation.stamp_s - FROM_S)
            geodetic = geodetic_from_enu(np.asarray(off, dtype=float), observation.geodetic)
            observation = replace(observation, geodetic=geodetic)
        yield observation


def returns(estimator) -> list[float]:
    """Return when the filter returned [s]: from a copy of before the doubt."""
    return [change.stamp_s for change in estimator.account() if change.reason == RETURNS]


def jumps(since_s: float) -> list[float]:
    return [0.4 * (since_s < UNTIL_S - FROM_S), 0.0, 0.0]


def runs_away(since_s: float) -> list[float]:
    return [0.5 * since_s * (since_s < UNTIL_S - FROM_S), 0.0, 0.0]


@pytest.mark.parametrize("fault", [jumps, runs_away])
@pytest.mark.parametrize("clock_std_s", [0.0, 0.05])
def test_it_returns_once_fixes_agree_with_the_state_of_before(
    cabin, start, run, errors_m, fault, clock_std_s: float
) -> None:
    """A clock that is known has its corrections in one compiled call, see `QueuedFilter`."""
    estimator = start(standing={"is_used": False}, clock_std_s=clock_std_s)
    states = run(estimator, moved(cabin.observations(END_S + 10.0), fault))
    assert max(errors_m(cabin, [s for s in states if s.stamp_s < UNTIL_S], FROM_S)) > 0.2
    assert max(errors_m(cabin, states, UNTIL_S + 0.5)) < 0.05
    assert len(returns(estimator)) == 1  # told as the reason of the next GLOBAL
    after = {state.status for state in states if UNTIL_S < state.stamp_s < END_S}
    assert SUSPECT in after
    assert GLOBAL not in after


def test_it_does_not_return_while_fixes_stay_where_they_jumped_to(cabin, start, run) -> None:
    """The copy becomes so uncertain that it would agree with anything: the jump decides."""
    estimator = start(standing={"is_used": False})
    run(estimator, moved(cabin.observations(28.0), lambda _: [0.0, 0.0, 3.0]))
    assert returns(estimator) == []


def test_a_wrong_inertial_sensor_is_no_reason_to_return(cabin, start, run, errors_m) -> None:
    """A copy that only inertial samples predict is wrong then, and fixes refute it."""
    estimator = start(standing={"is_used": False})

    def wrong():
        for one in cabin.observations(END_S + 10.0):
            if isinstance(one, ImuSample) and FROM_S < one.stamp_s < UNTIL_S:
                one = replace(one, specific_force_m_s2=one.specific_force_m_s2 + [1.0, 0.0, 0.0])
            yield one

    states = run(estimator, wrong())
    assert returns(estimator) == []
    assert max(errors_m(cabin, states, UNTIL_S)) < 0.5
