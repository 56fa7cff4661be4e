"""Odometry that fails while fixes hold the state: the filter without it takes over, unharmed."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.filters.error_state_ekf import ErrorStateEkf
from executive_plugins.estimation.filters.odometry_trial import OdometryTrial, separation_limit
from executive_plugins.estimation.filters.settings import ErrorStateEkfSettings
from executive_plugins.estimation.filters.witnessed_filter import WitnessedFilter
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from scipy.stats import chi2

from executive.geometry.pose import pose
from executive.messages.gnss import GnssFix
from executive.messages.odometry import LidarIncrement

FROM_S = 8.0
NOISE = InertialNoise(1e-3, 1e-2, 1e-5, 1e-4, 0.03, 9.81, 0.01)


def seldom(observations, way):
    """Yield one fix a second of each antenna, and increments whose way is scaled from 8 s on."""
    for one in observations:
        if isinstance(one, GnssFix) and abs(one.stamp_s - round(one.stamp_s)) > 1e-6:
            continue
        if isinstance(one, LidarIncrement) and one.to_s > FROM_S:
            if way is None:
                continue
            T = one.T_from_to
            one = replace(one, T_from_to=pose(T[:3, :3], way * T[:3, 3]))
        yield one


@pytest.fixture
def largest_m(cabin, machine, with_lidar, run, errors_m):
    """Return the largest error of a swinging cabin from 8 s on, and why odometry was refused."""

    def largest_m(way):
        settings = ErrorStateEkfSettings(standing={"is_used": False})
        estimator = ErrorStateEkf(settings, machine)
        estimator.start()
        states = run(estimator, seldom(with_lidar(cabin, cabin.observations(16.0)), way))
        return errors_m(cabin, states, FROM_S).max(), estimator.refused

    return largest_m


@pytest.mark.parametrize("way", [0.5, 2.0])
def test_odometry_with_a_wrong_way_harms_no_state_that_fixes_hold(largest_m, way):
    without_m, _ = largest_m(None)
    off_m, refused = largest_m(way)
    assert off_m < without_m + 0.01  # one increment of the wrong way is 0.1 m
    assert refused["odometry lidar_horizontal: contradicted by fixes and inertial samples"] > 20


def test_sound_odometry_is_used(largest_m):
    assert not any("odometry" in reason for reason in largest_m(1.0)[1])


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


def x_m(kalman):
    """Return where a filter is along its way [m]."""
    return kalman.state.p_map_imu[0]


def test_the_filter_without_odometry_is_reported_once_both_are_apart():
    both, trial = begun()
    shift(trial.user, 0.01)
    trial.conclude(False, 0.1)
    assert trial.trusts
    assert x_m(both) == pytest.approx(0.01, abs=1e-4)
    shift(trial.user, 0.2)
    trial.conclude(False, 0.1)
    assert not trial.trusts
    assert trial.user is both.other
    assert x_m(both) == 0.0
    assert x_m(both.other) > 0.1


def test_odometry_is_used_again_after_it_has_agreed_for_long_enough():
    both, trial = begun()
    trial.conclude(True, 0.1)
    for k in range(1, 12):
        assert not trial.trusts
        go_on(both, 0.1 * k)
        if k == 11:
            shift(trial.user, 0.01)
        trial.conclude(False, 0.1)
    assert trial.trusts
    assert x_m(both) == pytest.approx(1.11, abs=1e-3)


def test_without_fixes_odometry_is_used_though_it_was_refuted():
    both, trial = begun()
    trial.conclude(True, 0.1)
    trial.trust()
    assert trial.user is both


def test_a_doubt_about_the_state_begins_the_comparison_anew():
    both, trial = begun()
    shift(trial.user, 0.2)
    trial.dismiss()
    assert not trial.takes_fix(True, 1.0)
    trial.begin()
    trial.conclude(False, 0.1)
    assert x_m(both) == x_m(both.other) > 0.1


def test_a_fix_that_only_the_filter_without_odometry_explains_makes_that_one_the_reported_one():
    both, trial = begun()
    shift(trial.user, 0.2)
    assert trial.takes_fix(True, 1.0)
    assert not trial.trusts
    assert x_m(both) == x_m(both.other) == 0.0


def test_a_fix_that_only_the_filter_with_odometry_explains_brings_odometry_back():
    """The inertial samples have failed: they had separated the filters."""
    both, trial = begun()
    shift(trial.user, 0.2)
    trial.conclude(False, 0.1)
    assert not trial.trusts
    assert trial.takes_fix(True, 1.0)
    assert trial.trusts
    assert x_m(both) > 0.1


def test_a_fix_that_neither_filter_explains_leaves_odometry_in_use():
    both, trial = begun()
    shift(trial.user, 0.05)
    assert not trial.takes_fix(True, None)
    assert trial.trusts
    assert x_m(both) == x_m(both.other) == pytest.approx(0.05, abs=1e-3)


@pytest.mark.parametrize(("by_m", "is_used"), [(0.01, True), (0.2, False)])
def test_a_fix_that_neither_explains_brings_back_odometry_that_does_not_separate_them(
    by_m, is_used
):
    both, trial = begun()
    trial.conclude(True, 0.1)
    shift(trial.user, by_m)
    trial.conclude(False, 0.1)
    assert not trial.takes_fix(True, None)
    assert trial.trusts == is_used
    assert x_m(both) == pytest.approx(by_m if is_used else 0.0, abs=1e-3)


def test_a_fix_that_only_the_second_filter_contradicts_begins_the_comparison_anew():
    both, trial = begun()
    shift(trial.user, 0.05)
    assert not trial.takes_fix(False, None)
    assert trial.trusts
    assert x_m(both.other) == x_m(both) > 0.04


def test_chance_separates_sound_filters_once_an_hour():
    assert chi2.sf(separation_limit(0.125), 9) * 3600 / 0.125 == pytest.approx(1.0)


def test_the_errors_of_a_drift_add_up_along_the_way_since_the_last_fix(machine):
    """Ten increments of 0.1 m that err by 1 % each, all to one side, are 1 cm off in the end."""
    estimator = ErrorStateEkf(ErrorStateEkfSettings(fallback_after_s=10.0), machine)
    estimator.start()
    estimator._used_fix_s = 0.0
    step = pose(np.eye(3), np.array([0.1, 0.0, 0.0]))
    some = [LidarIncrement(k - 1.0, float(k), "lidar", step, np.eye(6)) for k in range(1, 11)]
    variance = sum(map(estimator._drift2, some))
    assert variance == pytest.approx((10 * 0.01 * 0.1) ** 2)
    later = LidarIncrement(99.0, 100.0, "lidar", step, np.eye(6))
    assert estimator._drift2(later) == pytest.approx(estimator._drift2(some[-1]))


def test_late_odometry_does_not_let_the_state_trail_while_fixes_hold_it(cabin, machine, with_lidar):
    estimator = ErrorStateEkf(ErrorStateEkfSettings(standing={"is_used": False}), machine)
    estimator.start()
    late = []
    for one in with_lidar(cabin, cabin.observations(6.0)):
        if isinstance(one, LidarIncrement):
            late.append(one)
            continue
        estimator.add(one)
        if late and late[0].to_s < estimator.state().stamp_s - 0.5:
            estimator.add_odometry(late.pop(0))
    assert estimator.refused["odometry lidar_horizontal: too late"] > 10
