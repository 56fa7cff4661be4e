"""Samples that are late, bad or missing."""

from dataclasses import replace

import numpy as np
from executive_plugins.estimation.cabin.estimator import INITIALISING

from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement


def test_fixes_late_and_out_of_order_are_used_within_the_lag(cabin, begin, run, errors_m) -> None:
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


def test_fixes_later_than_the_lag_are_refused_and_counted(cabin, begin, run) -> None:
    estimator = begin(smoother={"lag_s": 0.5})
    kept = []
    for observation in cabin.observations(6.0):
        if isinstance(observation, GnssFix) and 4.0 < observation.stamp_s < 4.3:
            kept.append(observation)
            continue
        run(estimator, [observation])
    run(estimator, [*kept, *cabin.observations(6.2, start_s=6.0)])
    assert estimator.refused["gnss_left: too late"] == 5


def test_every_kind_of_bad_sample_is_refused_and_changes_nothing(
    cabin, begin, with_lidar, run
) -> None:
    good, bad = begin(), begin()
    wild = np.array([0.0, 0.0, 900.0])
    for k, observation in enumerate(with_lidar(cabin, cabin.observations(7.0))):
        run(good, [observation])
        run(bad, [observation])
        if (
            isinstance(observation, ImuSample) and k and k % 50 == 0
        ):  # of two stamps, none is the right one
            bad.add_imu(observation)
            bad.add_imu(replace(observation, stamp_s=observation.stamp_s - 100.0))
            bad.add_imu(replace(observation, stamp_s=observation.stamp_s + 100.0))
            bad.add_imu(replace(observation, stamp_s=float("nan")))
            bad.add_imu(
                replace(observation, stamp_s=observation.stamp_s + 1e-4, specific_force_m_s2=wild)
            )
        if isinstance(observation, GnssFix) and k % 7 == 0:
            bad.add_gnss(observation)
            bad.add_gnss(replace(observation, antenna="gnss_roof"))
            bad.add_gnss(replace(observation, stamp_s=observation.stamp_s + 50.0))
            bad.add_gnss(
                replace(
                    observation,
                    stamp_s=observation.stamp_s + 1e-3,
                    covariance_enu_m2=2000.0 * np.eye(3),
                )
            )
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


def test_a_short_gap_of_inertial_samples_is_bridged_and_a_long_one_restarts(
    cabin, begin, run, errors_m
) -> None:
    for gap_s, status in ((0.5, "GLOBAL"), (3.0, INITIALISING)):
        end_s = 4.0 + gap_s
        estimator = begin(restart_after_s=2.0)
        observations = [
            o
            for o in cabin.observations(end_s + 1.0)
            if not (isinstance(o, ImuSample) and 4.0 < o.stamp_s < end_s)
        ]
        state = run(estimator, observations)[-1]
        assert state.status == status
        if state.is_ready:
            assert errors_m(cabin, [state])[0] < 0.05


def test_after_all_clocks_were_set_back_it_starts_again(cabin, begin, run, errors_m) -> None:
    estimator = begin()
    run(estimator, cabin.observations(104.0, start_s=100.0))
    states = run(estimator, cabin.observations(9.0))
    assert estimator.refused["imu_cabin: clock set back, followed"] == 1
    assert states[-1].status == "GLOBAL"
    again = [s for s in states if s.is_ready and s.stamp_s < 50]
    assert again[0].stamp_s < 4.0  # a second until the clock is believed, and two of rest
    assert errors_m(cabin, again).max() < 0.03


def test_after_a_gap_during_a_swing_fixes_restore_the_estimate(cabin, begin, run, errors_m) -> None:
    observations = [
        o
        for o in cabin.observations(13.0)
        if not (isinstance(o, ImuSample) and 8.5 < o.stamp_s < 10.0)
    ]
    states = run(begin(), observations)
    assert errors_m(cabin, states, 11.5).max() < 0.03
