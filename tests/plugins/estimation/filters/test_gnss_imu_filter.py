"""The filter on a swinging cabin whose motion is known in closed form."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from executive_plugins.estimation.cabin.estimator import INITIALISING
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.filters.settings import GnssImuSettings
from executive_plugins.estimation.filters.status_account import FALLBACK, GLOBAL, SUSPECT

from executive.errors import ConfigError
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import angle_between, from_rpy, log_so3
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample


def run(estimator, observations, every_s=0.05):
    """Feed all and return the states at cabin samples, `every_s` apart."""
    states, due_s = [], 0.0
    for observation in observations:
        estimator.add(observation)
        is_cabin = isinstance(observation, ImuSample) and observation.frame == "imu_cabin"
        if is_cabin and observation.stamp_s >= due_s:
            states.append(estimator.state())
            due_s = observation.stamp_s + every_s - 1e-6
    return states


def errors(cabin, states):
    """Return stamps, position errors [m], heading errors [rad] of the states that may be used."""
    rows = []
    for state in states:
        if state.is_ready:
            D = inverse(cabin.T_map_cabin(state.stamp_s)) @ state.T_map_cabin
            rows.append([state.stamp_s, np.linalg.norm(D[:3, 3]), abs(log_so3(D[:3, :3])[2])])
    return np.array(rows).T


def test_a_swinging_cabin_is_followed_to_millimetres(cabin, estimator) -> None:
    states = run(estimator, cabin.observations(34.0))
    stamps_s, position_m, heading_rad = errors(cabin, states)
    assert stamps_s[0] < 3.0
    assert position_m[stamps_s > 6].mean() < 0.006
    assert position_m.max() < 0.025
    assert np.degrees(heading_rad[stamps_s > 6]).mean() < 0.08
    assert np.degrees(heading_rad[stamps_s > 31]).max() < 0.1  # rests again since 30 s
    assert {state.status for state in states} == {INITIALISING, GLOBAL}
    assert estimator.refused == {}


def test_it_keeps_the_origin_of_the_map_and_nothing_before_there_is_one(cabin, start) -> None:
    estimator, other = start(datum=None), start(datum=None)
    assert (estimator.keep(), estimator.revision) == ({}, 0)
    run(estimator, cabin.observations(4.0))
    kept = estimator.keep()
    assert (list(kept), estimator.revision) == (["datum"], 1)
    assert other.map_origin is None
    assert estimator.map_origin == tuple(kept["datum"])
    other.restore(kept)
    np.testing.assert_array_equal(other.keep()["datum"], kept["datum"])
    assert other.map_origin == estimator.map_origin
    other.restore({})
    assert list(other.keep()) == ["datum"]


def test_velocity_and_rate_are_those_of_the_cabin(cabin, estimator) -> None:
    cabin.noise = 0.0
    states = run(estimator, cabin.observations(12.0))
    for state in states[-60:]:
        t, h = state.stamp_s - 0.005, 1e-4  # a sample is a mean over 10 ms, centred 5 ms ago
        v = (cabin.T_map_cabin(t + h)[:3, 3] - cabin.T_map_cabin(t - h)[:3, 3]) / (2 * h)
        np.testing.assert_allclose(state.v_map_cabin, v, atol=0.01)
        np.testing.assert_allclose(state.w_map_cabin_in_cabin, [0, 0, cabin.turn(t)[1]], atol=2e-3)


def test_the_chassis_stays_in_place_while_the_cabin_turns(cabin, estimator) -> None:
    states = [s for s in run(estimator, cabin.observations(16.0)) if s.stamp_s > 5]
    for state in states:
        assert np.linalg.norm(state.T_map_base[:3, 3] - cabin.T_map_base[:3, 3]) < 0.03
        assert np.degrees(angle_between(state.T_map_base[:3, :3], cabin.T_map_base[:3, :3])) < 0.35


def test_errors_are_within_the_covariance(cabin, estimator) -> None:
    squares = []
    for state in run(estimator, cabin.observations(30.0), every_s=0.5):
        if state.is_ready:
            D = inverse(cabin.T_map_cabin(state.stamp_s)) @ state.T_map_cabin
            error = np.concatenate([log_so3(D[:3, :3]), D[:3, 3]])
            squares.append(error @ np.linalg.solve(state.covariance, error))
    # Six degrees of freedom: 6 for a perfect model; less, for the inertial noise is taken as twice
    # the data sheet's.
    assert 1.0 < np.mean(squares) < 8.0


def test_latency_of_fixes_costs_nothing_up_to_the_lag(cabin, start) -> None:
    mean_m = {}
    for latency_s in (0.0, 0.1):
        cabin.gnss_latency_s = latency_s
        estimator = start(lag_s=0.12)
        stamps_s, position_m, _ = errors(cabin, run(estimator, cabin.observations(14.0)))
        mean_m[latency_s] = position_m[stamps_s > 6].mean()
        assert estimator.refused == {}
    assert mean_m[0.1] < mean_m[0.0] + 0.003


def test_the_lag_grows_with_late_fixes_and_the_first_ones_are_counted(cabin, start) -> None:
    cabin.gnss_latency_s = 0.3
    estimator = start(lag_s=0.1)
    states = run(estimator, cabin.observations(6.0))
    assert 0 < estimator.refused["gnss_left: too late"] < 10
    assert states[-1].status == GLOBAL


def test_fixes_that_are_seconds_late_are_refused_and_counted(cabin, start) -> None:
    cabin.gnss_latency_s = 2.5
    estimator = start(lag_s=0.1)
    states = run(estimator, cabin.observations(9.5))
    assert estimator.refused["gnss_left: too late"] >= 3
    assert states[-1].status == FALLBACK


def test_odometry_never_steps_when_satellites_come_back(cabin, start) -> None:
    estimator = start(standing={"is_used": False})
    observations = (
        o for o in cabin.observations(16.0) if not (isinstance(o, GnssFix) and 7 < o.stamp_s < 13)
    )
    states = [s for s in run(estimator, observations) if s.is_ready]
    steps = {"map": [], "odom": []}
    for before, after in pairwise(states):
        steps["map"].append(np.linalg.norm(after.T_map_base[:3, 3] - before.T_map_base[:3, 3]))
        steps["odom"].append(np.linalg.norm(after.T_odom_base[:3, 3] - before.T_odom_base[:3, 3]))
    assert max(steps["map"]) > 0.05  # six seconds on inertia alone, then the fix
    assert max(steps["odom"]) < 0.02


def test_a_chassis_at_rest_bounds_the_drift_without_satellites(cabin, estimator) -> None:
    observations = (
        o for o in cabin.observations(30.0) if not (isinstance(o, GnssFix) and 10 < o.stamp_s < 28)
    )
    states = run(estimator, observations)
    _, position_m, heading_rad = errors(cabin, states)
    assert position_m.max() < 0.05
    assert np.degrees(heading_rad).max() < 0.6
    status = {round(s.stamp_s, 2): s.status for s in states}
    assert (status[9.5], status[12.0], status[27.0], status[29.5]) == (
        GLOBAL,
        FALLBACK,
        FALLBACK,
        GLOBAL,
    )


def test_it_starts_while_the_cabin_turns(cabin, estimator) -> None:
    cabin.rest_s = 0.0
    cabin.period_s = 8.0
    cabin.swing_rad = 2.0
    states = run(estimator, cabin.observations(7.0))
    assert states[0].status == INITIALISING
    stamps_s, position_m, heading_rad = errors(cabin, states)
    assert stamps_s[0] < 5
    assert position_m[stamps_s > 5].max() < 0.05
    assert np.degrees(heading_rad[stamps_s > 5]).max() < 1.0


def test_a_second_chassis_pose_and_heading_are_found_as_well(cabin, estimator) -> None:
    cabin.T_map_base = pose(from_rpy(-0.08, 0.06, -2.7), np.array([-40.0, 25.0, -3.0]))
    stamps_s, position_m, heading_rad = errors(cabin, run(estimator, cabin.observations(10.0)))
    assert position_m[stamps_s > 4].max() < 0.025
    assert np.degrees(heading_rad[stamps_s > 4]).max() < 0.3


def test_without_a_datum_the_first_fix_is_the_origin(cabin, start) -> None:
    estimator = start(datum=None)
    state = run(estimator, cabin.observations(4.0))[-1]
    antenna = cabin.machine.sensors["gnss_left"].T_link_sensor[:3, 3]
    p_map_antenna = state.T_map_cabin[:3, :3] @ antenna + state.T_map_cabin[:3, 3]
    assert np.linalg.norm(p_map_antenna) < 0.06  # one fix of 8 and 15 mm


def test_invalid_samples_are_refused_and_change_nothing(cabin, start) -> None:
    good, bad = start(), start()
    wild = np.array([0.0, 0.0, 900.0])
    for k, observation in enumerate(cabin.observations(8.0)):
        good.add(observation)
        bad.add(observation)
        if isinstance(observation, ImuSample) and k % 50 == 0:
            bad.add_imu(observation)
            bad.add_imu(replace(observation, stamp_s=observation.stamp_s - 0.5))
            bad.add_imu(replace(observation, stamp_s=float("nan")))
            bad.add_imu(
                replace(observation, stamp_s=observation.stamp_s + 1e-4, specific_force_m_s2=wild)
            )
        if isinstance(observation, GnssFix) and k % 7 == 0:
            bad.add_gnss(replace(observation, antenna="gnss_roof"))
            bad.add_gnss(observation)
    reasons = {reason.split(": ")[1] for reason in bad.refused}
    assert reasons == {
        "duplicate",
        "back in time",
        "stamp not finite",
        "out of range",
        "unknown antenna",
    }
    np.testing.assert_allclose(bad.state().T_map_cabin, good.state().T_map_cabin, atol=1e-12)


def test_an_outlying_or_uncertain_fix_moves_nothing(cabin, estimator) -> None:
    for observation in cabin.observations(12.0):
        if isinstance(observation, GnssFix) and 8 < observation.stamp_s < 8.6:
            observation = replace(
                observation, geodetic=observation.geodetic + np.array([2e-5, 0, 0])
            )  # 2 m north
        if isinstance(observation, GnssFix) and 9 < observation.stamp_s < 9.5:
            vague = 2000.0 * np.eye(3)
            observation = replace(observation, covariance_enu_m2=vague, is_rtk_fixed=False)
        estimator.add(observation)
        if (
            isinstance(observation, ImuSample)
            and 7 < observation.stamp_s < 9.9
            and observation.frame == "imu_cabin"
        ):
            state = estimator.state()
            assert (
                np.linalg.norm(state.T_map_cabin[:3, 3] - cabin.T_map_cabin(state.stamp_s)[:3, 3])
                < 0.03
            )
    assert estimator.refused["gnss_left: outlier"] >= 8
    assert estimator.refused["gnss_left: too uncertain"] >= 8


def test_fixes_that_contradict_the_filter_for_long_are_used_in_the_end(cabin, estimator) -> None:
    at_20_s = ""
    for observation in cabin.observations(28.0):
        if isinstance(observation, GnssFix) and observation.stamp_s > 4:
            observation = replace(
                observation, geodetic=observation.geodetic + np.array([0, 0, 3.0])
            )
        estimator.add(observation)
        if isinstance(observation, GnssFix) and observation.stamp_s < 20:
            at_20_s = estimator.state().status
    state = estimator.state()
    assert at_20_s == SUSPECT  # until nothing has been in dispute for ten seconds
    assert state.T_map_cabin[2, 3] - cabin.T_map_cabin(state.stamp_s)[2, 3] == pytest.approx(
        3.0, abs=0.1
    )
    assert state.status == GLOBAL


def test_a_short_gap_of_inertial_samples_is_bridged_and_a_long_one_restarts(cabin, start) -> None:
    for gap_s, restarts in ((0.5, False), (3.0, True)):
        estimator = start(restart_after_s=2.0)
        end_s = 4.0 + gap_s
        observations = (
            o
            for o in cabin.observations(end_s + 2.5)
            if not (isinstance(o, ImuSample) and 4.0 < o.stamp_s < end_s)
        )
        states = run(estimator, observations)
        after = {state.status for state in states if state.stamp_s > end_s}
        assert (INITIALISING in after) == restarts
        state = states[-1]
        assert state.status == GLOBAL
        away = state.T_map_cabin[:3, 3] - cabin.T_map_cabin(state.stamp_s)[:3, 3]
        assert np.linalg.norm(away) < 0.05


def test_after_a_gap_during_a_swing_fixes_restore_the_estimate(cabin, estimator) -> None:
    observations = (
        o
        for o in cabin.observations(12.0)
        if not (isinstance(o, ImuSample) and 8.5 < o.stamp_s < 10.0)
    )
    stamps_s, position_m, heading_rad = errors(cabin, run(estimator, observations))
    assert estimator.refused == {}
    assert (
        np.degrees(heading_rad[(stamps_s > 10.0) & (stamps_s < 10.2)]).max() < 6
    )  # the cabin turned by 60°
    assert np.degrees(heading_rad[stamps_s > 11.0]).max() < 0.5
    assert position_m[stamps_s > 11.0].max() < 0.03


def test_the_same_samples_give_the_same_state(cabin, start) -> None:
    first, second = (run(start(), cabin.observations(7.0))[-1] for _ in range(2))
    np.testing.assert_array_equal(first.T_map_cabin, second.T_map_cabin)


def test_an_unknown_imu_is_refused_at_the_start_with_the_known_ones(machine) -> None:
    with pytest.raises(ConfigError, match="'imu_roof' is no imu on the cabin; there is: imu_cabin"):
        GnssImuFilter(GnssImuSettings(imu="imu_roof"), machine).start()
