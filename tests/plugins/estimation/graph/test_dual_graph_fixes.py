"""Fixes that are missing or wrong: outages, spikes, plateaus, ramps and a change of datum."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.modes import Mode
from executive_plugins.estimation.start.found import Found

from executive.geometry.pose import inverse, pose
from executive.messages.gnss import GnssFix
from executive.messages.odometry import LidarIncrement

NO_STANDING = {"is_used": False}


@pytest.mark.parametrize("fallback", ["relative", "pseudo_global"])
def test_lidar_bounds_the_drift_in_an_outage_during_a_swing(
    fallback, cabin, begin, with_lidar, shifted, run, errors_m, reasons
) -> None:
    estimator = begin(standing=NO_STANDING, smoother={"lag_s": 1.5, "fallback": fallback})
    observations = shifted(cabin.observations(24.0), lambda t: None if 8 < t < 20 else np.zeros(3))
    states = run(estimator, with_lidar(cabin, observations))
    assert errors_m(cabin, states).max() < 0.12
    assert [c.after for c in estimator.changes] == [
        Mode.SUSPECT,
        Mode.FALLBACK,
        Mode.RECOVERING,
        Mode.GLOBAL,
    ]
    assert "no good fix" in reasons(estimator, Mode.FALLBACK)[0]
    back = next(c.stamp_s for c in estimator.changes if c.after == Mode.GLOBAL)
    assert 20.0 < back < 21.5
    assert errors_m(cabin, states, 21.5).max() < 0.02
    std_m = [
        np.sqrt(np.trace(s.covariance[3:, 3:]))
        for s in states
        if s.is_ready and 10 < s.stamp_s < 20
    ]
    assert std_m[-1] > 1.2 * std_m[0]  # what is only reckoned is known worse and worse
    away = [s for s in states if s.is_ready and 10 < s.stamp_s < 20]
    assert np.median(errors_m(cabin, away) / std_m) < 2


def test_the_odometry_frame_does_not_step_when_satellites_come_back(
    cabin, begin, shifted, run, errors_m
) -> None:
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


def test_spikes_of_good_covariance_move_nothing(
    cabin, begin, shifted, run, errors_m, reasons
) -> None:
    estimator = begin()
    spike = np.array([2.0, 2.5, 1.0])
    observations = shifted(
        cabin.observations(14.0), lambda t: spike * (8 < t < 8.4 or 10 < t < 10.1)
    )
    states = run(estimator, observations)
    assert errors_m(cabin, states).max() < 0.03
    assert estimator.refused["gnss_left: outlier"] >= 8
    assert "3.3" in reasons(estimator, Mode.SUSPECT)[0]
    assert states[-1].status == "GLOBAL"


def test_fixes_that_are_off_by_a_metre_for_a_while_are_not_used(
    cabin, begin, with_lidar, shifted, run, errors_m
) -> None:
    estimator = begin()
    observations = shifted(cabin.observations(18.0), lambda t: np.array([1.0, 0, 0]) * (8 < t < 13))
    states = run(estimator, with_lidar(cabin, observations))
    assert errors_m(cabin, states).max() < 0.08
    assert states[-1].status == "GLOBAL"
    back = next(c.stamp_s for c in estimator.changes if c.after == Mode.GLOBAL and c.stamp_s > 13)
    assert back < 14.5


def test_a_slow_ramp_is_reported_and_its_fixes_are_in_doubt(
    cabin, begin, with_lidar, shifted, run, errors_m, reasons
) -> None:
    estimator = begin(standing=NO_STANDING)
    observations = shifted(
        cabin.observations(20.0), lambda t: np.array([0.1, 0, 0]) * min(max(t - 7, 0), 20)
    )
    states = run(estimator, with_lidar(cabin, observations, std_m=0.002, std_rad=0.0002))
    assert "against the odometry" in " ".join(reasons(estimator, Mode.SUSPECT))
    # Seen once it exceeds the drift that odometry is allowed: 3 % of the way, and 0.1 m.
    claimed = [state for state in states if state.status == "GLOBAL"]
    assert errors_m(cabin, claimed).max() < 0.4
    assert states[-1].status == "SUSPECT"


@pytest.mark.parametrize("step_m", [0.01, -0.03])
def test_odometry_that_drifts_beside_good_fixes_is_left_and_used_again(
    cabin, begin, with_lidar, run, errors_m, step_m
) -> None:
    """Of 0.1 and 0.3 m/s for five seconds, in which no fix is refused."""
    estimator = begin(standing=NO_STANDING)
    observations = [
        replace(one, T_from_to=one.T_from_to @ pose(t=np.array([step_m, 0.0, 0.0])))
        if isinstance(one, LidarIncrement) and 7.0 < one.to_s < 12.0
        else one
        for one in with_lidar(cabin, cabin.observations(28.0), std_m=0.002, std_rad=0.0002)
    ]
    states = run(estimator, observations)
    assert errors_m(cabin, states).max() < 0.06
    assert not any("outlier" in name for name in estimator.refused if name.startswith("gnss"))
    assert states[-1].status == "GLOBAL"
    assert estimator._host._smoother._odometry.is_trusted


def test_a_change_of_datum_is_accepted_after_a_while_and_reported(
    cabin, begin, with_lidar, shifted, run, reasons
) -> None:
    estimator = begin()
    observations = shifted(cabin.observations(22.0), lambda t: np.array([3.0, 4.0, 0]) * (t > 6))
    state = run(estimator, with_lidar(cabin, observations))[-1]
    np.testing.assert_allclose(
        state.T_map_cabin[:3, 3] - cabin.T_map_cabin(state.stamp_s)[:3, 3], [3, 4, 0], atol=0.03
    )
    assert "position reset" in reasons(estimator, Mode.GLOBAL)[-1]
    assert estimator.changes[-1].stamp_s < 21.0


def test_fixes_are_used_with_the_clock_and_the_scatter_that_the_start_has_seen(
    begin, monkeypatch
) -> None:
    estimator, z = begin(), np.zeros(3)
    state = InertialState(Inertial(1.0, z, np.array([0.0, 0.0, 9.81])), np.eye(3), z, z, z, z)
    found = Found(state, 1e-4 * np.eye(15), True, ClockOffset(0.02, 0.01), fix_scale=6.0)
    estimator._start_at(found)
    estimator._is_begun, used = True, []
    monkeypatch.setattr(estimator._host, "add", used.append)
    fix = GnssFix(1.5, "gnss_left", np.array([47.4084, 8.5106, 440.0]), 1e-4 * np.eye(3), True)
    estimator._use_fix(fix, z, fix.covariance_enu_m2)
    assert (used[0].stamp_s, used[0].late_s) == (1.48, 0.02)
    assert used[0].covariance == pytest.approx(6e-4 * np.eye(3))
    estimator.close()
