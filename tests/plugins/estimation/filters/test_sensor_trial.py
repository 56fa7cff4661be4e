"""An inertial sensor that errs for seconds: the filter finds which one, and recovers at the end."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.filters.status_account import GLOBAL, SUSPECT

from executive.geometry.geodesy import geodetic_from_enu
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.observation import Observation

FROM_S, UNTIL_S, END_S = 8.0, 14.0, 28.0
NO_REST = {"is_used": False}


def wrong(
    observations: Iterable[Observation], rate: float = 0.0, force: float = 0.0
) -> Iterable[Observation]:
    """Add a bias along x to the inertial samples of the cabin for some time."""
    for one in observations:
        if isinstance(one, ImuSample) and FROM_S < one.stamp_s < UNTIL_S:
            one = replace(
                one,
                angular_velocity_rad_s=one.angular_velocity_rad_s + [rate, 0.0, 0.0],
                specific_force_m_s2=one.specific_force_m_s2 + [force, 0.0, 0.0],
            )
        yield one


@pytest.fixture
def causes(monkeypatch, start):
    """Start a filter; return it with the causes that its trial of the sensors finds."""

    def begun(**settings):
        estimator, found = start(**settings), []
        take_over = estimator._sensors.take_over

        def told(trailing, fix, since_s: float) -> str:
            cause = take_over(trailing, fix, since_s)
            if cause:
                found.append(cause)
            return cause

        monkeypatch.setattr(estimator._sensors, "take_over", told)
        return estimator, found

    return begun


@pytest.mark.parametrize(("sensor", "bias"), [("force", 1.0), ("rate", 0.1)])
@pytest.mark.parametrize("clock_std_s", [0.0, 0.05])
def test_the_sensor_that_errs_is_found_and_the_state_stays_right(
    cabin, causes, run, errors_m, sensor: str, bias: float, clock_std_s: float
) -> None:
    estimator, found = causes(standing=NO_REST, clock_std_s=clock_std_s)
    states = run(estimator, wrong(cabin.observations(END_S), **{sensor: bias}))
    assert f"wrong {sensor}s of the inertial sensor" in found
    during = [state for state in states if FROM_S < state.stamp_s < UNTIL_S]
    assert SUSPECT in {state.status for state in during}
    assert max(errors_m(cabin, states, FROM_S)) < 0.1
    assert max(errors_m(cabin, states, UNTIL_S + 2.0)) < 0.05
    assert states[-1].status == GLOBAL


def test_biases_walk_no_longer_once_nothing_is_in_doubt(cabin, start, run) -> None:
    estimator = start(standing=NO_REST)
    sound = estimator._noise.densities
    run(estimator, wrong(cabin.observations(UNTIL_S), force=1.0))
    assert not np.array_equal(estimator._trailing.kalman.block["densities"][0], sound)
    estimator = start(standing=NO_REST)
    run(estimator, wrong(cabin.observations(END_S + 4.0), force=1.0))
    assert np.array_equal(estimator._trailing.kalman.block["densities"][0], sound)


def test_noisy_fixes_accuse_no_sensor(cabin, causes, run) -> None:
    rng = np.random.default_rng(5)

    def noisy():
        for one in cabin.observations(UNTIL_S):
            if isinstance(one, GnssFix) and one.stamp_s > FROM_S:
                off = rng.normal(0, 0.06, 3)
                one = replace(one, geodetic=geodetic_from_enu(off, one.geodetic))
            yield one

    estimator, found = causes(standing=NO_REST)
    run(estimator, noisy())
    assert not any("inertial" in cause for cause in found)


@pytest.mark.parametrize("silent_s", [0.0, 0.3])
def test_a_gap_in_the_samples_explains_a_doubt_by_itself(cabin, causes, run, silent_s) -> None:
    """A state of before the gap says nothing of the sensors."""
    estimator, found = causes(standing=NO_REST)

    def silent():
        for one in wrong(cabin.observations(FROM_S + 1.0), force=1.0):
            if not (isinstance(one, ImuSample) and FROM_S - silent_s < one.stamp_s < FROM_S):
                yield one

    run(estimator, silent())
    assert bool(found) == (silent_s == 0.0)
