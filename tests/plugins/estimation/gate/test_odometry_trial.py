"""Which of two filters is reported: by what odometry separates, and by what fixes say of both."""

import numpy as np
import pytest
from executive_plugins.estimation.filters.witnessed_filter import WitnessedFilter
from executive_plugins.estimation.gate.odometry_trial import OdometryTrial, separation_limit
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from scipy.stats import chi2

NOISE = InertialNoise(1e-3, 1e-2, 1e-5, 1e-4, 0.03, 9.81, 0.01)


def pair():
    """Return two filters that are equal and drive at 1 m/s."""
    state = InertialState(
        Inertial(0.0, np.zeros(3), np.array([0, 0, 9.81])),
        np.eye(3),
        np.zeros(3),
        np.array([1.0, 0.0, 0.0]),
        np.zeros(3),
        np.zeros(3),
    )
    return WitnessedFilter(state, 1e-4 * np.eye(15), NOISE, ClockOffset())


def go_on(both, stamp_s):
    """Predict both filters at constant velocity."""
    for one in (both, both.other):
        one.predict(Inertial(stamp_s, np.zeros(3), np.array([0, 0, 9.81]), 0.1))


def shift(kalman, by_m):
    """Move a filter by an odometry that is exact."""
    H = np.zeros((3, 15))
    H[:, 6:9] = np.eye(3)
    assert kalman.correct(np.array([by_m, 0, 0]), H, 1e-8 * np.eye(3), 1e9)


def begun(**settings):
    """Return two filters and a trial of them that has begun."""
    both = pair()
    trial = OdometryTrial(both, **{"trusted_after_s": 1.0, **settings})
    trial.begin()
    return both, trial


def user(both, trial):
    """Return the filter that uses odometry."""
    return both if trial.trusts else both.other


def x_m(kalman):
    """Return where a filter is along its way [m]."""
    return kalman.state.p_map_imu[0]


def test_the_filter_without_odometry_is_reported_once_both_are_apart():
    both, trial = begun()
    shift(user(both, trial), 0.01)
    trial.conclude(False, 0.1)
    assert trial.trusts
    assert x_m(both) == pytest.approx(0.01, abs=1e-4)
    shift(user(both, trial), 0.2)
    trial.conclude(False, 0.1)
    assert not trial.trusts
    assert user(both, trial) is both.other
    assert x_m(both) == 0.0
    assert x_m(both.other) > 0.1


def test_the_filter_that_odometry_has_moved_gives_way_once():
    both, trial = begun()
    shift(both, 0.01)
    moved_m, other_m = x_m(both), x_m(both.other)
    assert trial.give_way()
    assert (x_m(both), x_m(both.other)) == (other_m, moved_m)
    assert not trial.trusts
    assert not trial.give_way()
    assert x_m(both) == other_m


def test_nothing_gives_way_while_nothing_is_compared():
    both, trial = begun()
    trial.dismiss()
    shift(both, 0.01)
    moved_m = x_m(both)
    assert not trial.give_way()
    assert (x_m(both), trial.trusts) == (moved_m, True)


def test_odometry_is_used_again_after_it_has_agreed_for_long_enough():
    both, trial = begun()
    trial.conclude(True, 0.1)
    for k in range(1, 12):
        assert not trial.trusts
        go_on(both, 0.1 * k)
        if k == 11:
            shift(user(both, trial), 0.01)
        trial.conclude(False, 0.1)
    assert trial.trusts
    assert x_m(both) == pytest.approx(1.11, abs=1e-3)


def test_without_fixes_odometry_is_used_though_it_was_refuted():
    both, trial = begun()
    trial.conclude(True, 0.1)
    trial.trust()
    assert user(both, trial) is both


def test_a_doubt_about_the_state_begins_the_comparison_anew():
    both, trial = begun()
    shift(user(both, trial), 0.2)
    trial.dismiss()
    assert not trial.takes_fix(True, 1.0)
    trial.begin()
    trial.conclude(False, 0.1)
    assert x_m(both) == x_m(both.other) > 0.1


def test_a_fix_that_only_the_filter_without_odometry_explains_makes_that_one_the_reported_one():
    both, trial = begun()
    shift(user(both, trial), 0.2)
    assert trial.takes_fix(True, 1.0)
    assert not trial.trusts
    assert x_m(both) == x_m(both.other) == 0.0


def test_a_fix_that_only_the_filter_with_odometry_explains_brings_odometry_back():
    """The inertial samples have failed: they had separated the filters."""
    both, trial = begun()
    shift(user(both, trial), 0.2)
    trial.conclude(False, 0.1)
    assert not trial.trusts
    assert trial.takes_fix(True, 1.0)
    assert trial.trusts
    assert x_m(both) > 0.1


def test_a_fix_that_neither_filter_explains_leaves_odometry_in_use():
    both, trial = begun()
    shift(user(both, trial), 0.05)
    assert not trial.takes_fix(True, None)
    assert trial.trusts
    assert x_m(both) == x_m(both.other) == pytest.approx(0.05, abs=1e-3)


@pytest.mark.parametrize(("by_m", "is_used"), [(0.01, True), (0.2, False)])
def test_a_fix_that_neither_explains_brings_back_odometry_that_does_not_separate_them(
    by_m, is_used
):
    both, trial = begun()
    trial.conclude(True, 0.1)
    shift(user(both, trial), by_m)
    trial.conclude(False, 0.1)
    assert not trial.takes_fix(True, None)
    assert trial.trusts == is_used
    assert x_m(both) == pytest.approx(by_m if is_used else 0.0, abs=1e-3)


def test_a_fix_that_only_the_second_filter_contradicts_begins_the_comparison_anew():
    both, trial = begun()
    shift(user(both, trial), 0.05)
    assert not trial.takes_fix(False, None)
    assert trial.trusts
    assert x_m(both.other) == x_m(both) > 0.04


def test_chance_separates_sound_filters_once_an_hour():
    assert chi2.sf(separation_limit(0.125), 9) * 3600 / 0.125 == pytest.approx(1.0)
