"""The dual graph on a swinging cabin whose motion is known in closed form, with outages, wrong fixes, bad samples."""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from executive.errors import ConfigError
from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import exp_so3, log_so3
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.odometry import LidarIncrement
from plugins.estimation.dual_graph import INITIALISING, DualGraph
from plugins.estimation.dual_graph_settings import DualGraphSettings
from plugins.estimation.estimator_modes import Mode

LIDAR = "lidar_horizontal"
NO_STANDING = {"is_used": False}


@pytest.fixture
def begin(machine) -> Iterator[Callable[..., DualGraph]]:
    """Make and start estimators; close them in the end."""
    begun = []

    def begin(**settings: object) -> DualGraph:
        settings = {"smoother": {"lag_s": 1.5}} | settings  # half the default: the tests take half the time
        estimator = DualGraph(DualGraphSettings(**settings), machine)
        estimator.start()
        begun.append(estimator)
        return estimator

    yield begin
    for estimator in begun:
        estimator.close()


def with_lidar(cabin, observations, std_m=0.005, std_rad=0.0005):
    """Yield the observations and, after each tenth cabin sample, the increment since the last, late by 50 ms."""
    rng = np.random.default_rng(7)
    T_cabin_lidar = cabin.machine.sensors[LIDAR].T_link_sensor
    covariance = np.diag(np.repeat([std_rad**2, std_m**2], 3))
    for observation in observations:
        yield observation
        if isinstance(observation, ImuSample) and observation.frame == "imu_cabin":
            k = round(100 * observation.stamp_s) - 5
            if k >= 10 and k % 10 == 0:
                before, after = (cabin.T_map_cabin(t) @ T_cabin_lidar for t in (k / 100 - 0.1, k / 100))
                error = pose(exp_so3(rng.normal(0, std_rad, 3)), rng.normal(0, std_m, 3))
                yield LidarIncrement(k / 100 - 0.1, k / 100, LIDAR, inverse(before) @ after @ error, covariance)


def shifted(observations, shift_enu: Callable[[float], np.ndarray | None]):
    """Move each fix by what a function of time says; None drops it."""
    for observation in observations:
        if isinstance(observation, GnssFix):
            shift = shift_enu(observation.stamp_s)
            if shift is None:
                continue
            datum = observation.geodetic
            observation = replace(observation, geodetic=geodetic_from_enu(np.asarray(shift, dtype=float), datum))
        yield observation


def run(estimator, observations):
    """Feed all; return the states at every fifth cabin sample."""
    states = []
    verbs = {
        ImuSample: estimator.add_imu,
        GnssFix: estimator.add_gnss,
        JointSample: estimator.add_joints,
        LidarIncrement: estimator.add_odometry,
    }
    for observation in observations:
        verbs[type(observation)](observation)
        is_cabin = isinstance(observation, ImuSample) and observation.frame == "imu_cabin"
        if is_cabin and round(100 * observation.stamp_s) % 5 == 0:
            states.append(estimator.state())
    return states


def errors_m(cabin, states, after_s=0.0):
    return np.array(
        [
            np.linalg.norm((s.T_map_cabin - cabin.T_map_cabin(s.stamp_s))[:3, 3])
            for s in states
            if s.is_ready and s.stamp_s >= after_s
        ]
    )


def reasons(estimator, after):
    return [change.reason for change in estimator.changes if change.after == after]


def test_a_swinging_cabin_is_followed_to_millimetres(cabin, begin) -> None:
    estimator = begin()
    states = run(estimator, cabin.observations(16.0))
    assert errors_m(cabin, states, 6.0).mean() < 0.005
    assert errors_m(cabin, states).max() < 0.02
    heading = [log_so3((inverse(cabin.T_map_cabin(s.stamp_s)) @ s.T_map_cabin)[:3, :3])[2] for s in states[-150:]]
    assert np.degrees(np.abs(heading)).mean() < 0.08
    assert {s.status for s in states} == {INITIALISING, "GLOBAL"}
    assert estimator.refused == {}
    assert estimator.changes == []


def test_covariance_is_honest(cabin, begin) -> None:
    squares = []
    for state in run(begin(), with_lidar(cabin, cabin.observations(20.0)))[::10]:
        if state.is_ready:
            D = inverse(cabin.T_map_cabin(state.stamp_s)) @ state.T_map_cabin
            error = np.concatenate([log_so3(D[:3, :3]), D[:3, 3]])
            squares.append(error @ np.linalg.solve(state.covariance, error))
    # Six degrees of freedom: 6 for a perfect model; less, for the inertial noise is taken as twice the data sheet's.
    assert 1.0 < np.mean(squares) < 8.0
    assert np.mean(np.array(squares) < 16.8) > 0.9  # the 99 % bound


def test_velocity_and_rate_are_those_of_the_cabin(cabin, begin) -> None:
    cabin.noise = 0.0
    for state in run(begin(), cabin.observations(12.0))[-60:]:
        t, h = state.stamp_s - 0.005, 1e-4  # a sample is a mean over 10 ms, centred 5 ms ago
        v = (cabin.T_map_cabin(t + h)[:3, 3] - cabin.T_map_cabin(t - h)[:3, 3]) / (2 * h)
        np.testing.assert_allclose(state.v_map_cabin, v, atol=0.01)
        np.testing.assert_allclose(state.w_map_cabin_in_cabin, [0, 0, cabin.turn(t)[1]], atol=2e-3)


def test_lidar_carries_it_through_an_outage_in_mid_swing(cabin, begin) -> None:
    estimator = begin(standing=NO_STANDING)
    observations = shifted(cabin.observations(24.0), lambda t: None if 8 < t < 20 else np.zeros(3))
    states = run(estimator, with_lidar(cabin, observations))
    assert errors_m(cabin, states).max() < 0.12
    assert [c.after for c in estimator.changes] == [Mode.SUSPECT, Mode.FALLBACK, Mode.RECOVERING, Mode.GLOBAL]
    assert "no good fix" in reasons(estimator, Mode.FALLBACK)[0]
    back = next(c.stamp_s for c in estimator.changes if c.after == Mode.GLOBAL)
    assert 20.0 < back < 21.5
    assert errors_m(cabin, states, 21.5).max() < 0.02


def test_the_odometry_frame_does_not_step_when_satellites_come_back(cabin, begin) -> None:
    estimator = begin(standing=NO_STANDING)
    observations = shifted(cabin.observations(16.0), lambda t: None if 7 < t < 13 else np.zeros(3))
    states = [s for s in run(estimator, observations) if s.is_ready]  # six seconds on inertia alone
    steps = {"map": [], "odom": []}
    for before, after in pairwise(states):
        steps["map"].append(np.linalg.norm(after.T_map_base[:3, 3] - before.T_map_base[:3, 3]))
        steps["odom"].append(np.linalg.norm(after.T_odom_base[:3, 3] - before.T_odom_base[:3, 3]))
    assert max(steps["map"]) > 0.05
    assert max(steps["odom"]) < 0.02
    assert states[-1].status == "GLOBAL"
    assert errors_m(cabin, states, 15.0).max() < 0.03
    last = states[-1]
    T_map_odom = last.T_map_base @ inverse(last.T_odom_base)  # Eq. (11)
    assert np.linalg.norm(T_map_odom[:3, 3]) > 0.01


def test_a_standing_chassis_holds_the_estimate_without_satellites(cabin, begin) -> None:
    observations = shifted(cabin.observations(20.0), lambda t: None if t > 10 else np.zeros(3))
    assert errors_m(cabin, run(begin(), observations)).max() < 0.05


def test_spikes_of_good_covariance_move_nothing(cabin, begin) -> None:
    estimator = begin()
    spike = np.array([2.0, 2.5, 1.0])
    observations = shifted(cabin.observations(14.0), lambda t: spike * (8 < t < 8.4 or 10 < t < 10.1))
    states = run(estimator, observations)
    assert errors_m(cabin, states).max() < 0.03
    assert estimator.refused["gnss_left: outlier"] >= 8
    assert "3.3" in reasons(estimator, Mode.SUSPECT)[0]
    assert states[-1].status == "GLOBAL"


def test_a_plateau_of_a_metre_is_waited_out_on_lidar(cabin, begin) -> None:
    estimator = begin()
    observations = shifted(cabin.observations(18.0), lambda t: np.array([1.0, 0, 0]) * (8 < t < 13))
    states = run(estimator, with_lidar(cabin, observations))
    assert errors_m(cabin, states).max() < 0.08
    assert states[-1].status == "GLOBAL"
    back = next(c.stamp_s for c in estimator.changes if c.after == Mode.GLOBAL and c.stamp_s > 13)
    assert back < 14.5


def test_a_slow_ramp_is_flagged_and_taken_back(cabin, begin) -> None:
    estimator = begin(standing=NO_STANDING)
    observations = shifted(cabin.observations(20.0), lambda t: np.array([0.1, 0, 0]) * min(max(t - 7, 0), 20))
    states = run(estimator, with_lidar(cabin, observations, std_m=0.002, std_rad=0.0002))
    assert "against the odometry" in " ".join(reasons(estimator, Mode.SUSPECT))
    assert errors_m(cabin, states).max() < 0.3
    assert states[-1].status in ("FALLBACK", "RECOVERING")


def test_a_change_of_datum_is_believed_in_the_end_and_flagged(cabin, begin) -> None:
    estimator = begin()
    observations = shifted(cabin.observations(22.0), lambda t: np.array([3.0, 4.0, 0]) * (t > 6))
    state = run(estimator, with_lidar(cabin, observations))[-1]
    np.testing.assert_allclose(state.T_map_cabin[:3, 3] - cabin.T_map_cabin(state.stamp_s)[:3, 3], [3, 4, 0], atol=0.03)
    assert "anchored anew" in reasons(estimator, Mode.GLOBAL)[-1]
    assert estimator.changes[-1].stamp_s < 21.0


def test_fixes_late_and_out_of_order_are_used_within_the_lag(cabin, begin) -> None:
    cabin.gnss_latency_s = 0.0
    on_time = list(cabin.observations(14.0))
    fixes = [o for o in on_time if isinstance(o, GnssFix)]
    rest = [o for o in on_time if not isinstance(o, GnssFix)]
    rng = np.random.default_rng(3)
    early = [(f.stamp_s + (rng.uniform(0.0, 0.5) if f.stamp_s > 4 else 0.0), f) for f in fixes]
    arrivals = sorted([*((o.stamp_s - 1e-3, o) for o in rest), *early], key=lambda a: a[0])
    estimator = begin()
    states = run(estimator, [o for _, o in arrivals])
    assert estimator.refused == {}
    assert errors_m(cabin, states).max() < 0.03


def test_fixes_later_than_the_lag_are_refused_and_counted(cabin, begin) -> None:
    estimator = begin(smoother={"lag_s": 0.5})
    kept = []
    for observation in cabin.observations(6.0):
        if isinstance(observation, GnssFix) and 4.0 < observation.stamp_s < 4.3:
            kept.append(observation)
            continue
        run(estimator, [observation])
    run(estimator, [*kept, *cabin.observations(6.2, start_s=6.0)])
    assert estimator.refused["gnss_left: too late"] == 5


def test_every_kind_of_bad_sample_is_refused_and_changes_nothing(cabin, begin) -> None:
    good, bad = begin(), begin()
    wild = np.array([0.0, 0.0, 900.0])
    for k, observation in enumerate(with_lidar(cabin, cabin.observations(7.0))):
        run(good, [observation])
        run(bad, [observation])
        if isinstance(observation, ImuSample) and k % 50 == 0:
            bad.add_imu(observation)
            bad.add_imu(replace(observation, stamp_s=observation.stamp_s - 100.0))
            bad.add_imu(replace(observation, stamp_s=float("nan")))
            bad.add_imu(replace(observation, stamp_s=observation.stamp_s + 1e-4, specific_force_m_s2=wild))
        if isinstance(observation, GnssFix) and k % 7 == 0:
            bad.add_gnss(observation)
            bad.add_gnss(replace(observation, antenna="gnss_roof"))
            bad.add_gnss(replace(observation, stamp_s=observation.stamp_s + 50.0))
            bad.add_gnss(replace(observation, stamp_s=observation.stamp_s + 1e-3, covariance_enu_m2=np.eye(3)))
        if isinstance(observation, LidarIncrement):
            bad.add_odometry(observation)
            bad.add_odometry(replace(observation, to_s=observation.from_s))
    assert {reason.split(": ")[1] for reason in bad.refused} == {
        "duplicate",
        "back in time",
        "stamp not finite",
        "out of range",
        "unknown antenna",
        "ahead of time",
        "too uncertain",
        "stamps not in order",
    }
    np.testing.assert_allclose(bad.state().T_map_cabin, good.state().T_map_cabin, atol=1e-12)


def test_a_gap_of_inertial_samples_is_bridged_or_begins_anew(cabin, begin) -> None:
    for gap_s, status in ((0.5, "GLOBAL"), (3.0, INITIALISING)):
        end_s = 4.0 + gap_s
        estimator = begin(restart_after_s=2.0)
        observations = [
            o for o in cabin.observations(end_s + 1.0) if not (isinstance(o, ImuSample) and 4.0 < o.stamp_s < end_s)
        ]
        state = run(estimator, observations)[-1]
        assert state.status == status
        if state.is_ready:
            assert errors_m(cabin, [state])[0] < 0.05


def test_a_gap_of_inertial_samples_in_mid_swing_is_followed_by_satellites(cabin, begin) -> None:
    observations = [o for o in cabin.observations(13.0) if not (isinstance(o, ImuSample) and 8.5 < o.stamp_s < 10.0)]
    states = run(begin(), observations)
    assert errors_m(cabin, states, 11.5).max() < 0.03


def test_refuses_to_begin_while_the_cabin_turns(cabin, begin) -> None:
    cabin.rest_s, cabin.period_s, cabin.swing_rad = 0.0, 8.0, 2.0
    assert {s.status for s in run(begin(), cabin.observations(7.0))} == {INITIALISING}


def test_the_same_samples_give_the_same_state(cabin, begin) -> None:
    first, second = (run(begin(), with_lidar(cabin, cabin.observations(7.0)))[-1] for _ in range(2))
    np.testing.assert_array_equal(first.T_map_cabin, second.T_map_cabin)


def test_in_a_process_of_its_own_it_follows_the_cabin_as_well(cabin, begin) -> None:
    estimator = begin(process=True)
    states = []
    for observation in cabin.observations(9.0):
        states += run(estimator, [observation])
        if isinstance(observation, ImuSample):
            time.sleep(0.002)  # the child needs time of its own, though less than on the machine
    assert errors_m(cabin, states, 6.0).max() < 0.06
    assert states[-1].status == "GLOBAL"


def test_an_unknown_imu_is_refused_at_the_start_with_the_known_ones(machine) -> None:
    with pytest.raises(ConfigError, match="'imu_roof' is no imu on the cabin; there is: imu_cabin"):
        DualGraph(DualGraphSettings(imu="imu_roof"), machine).start()
