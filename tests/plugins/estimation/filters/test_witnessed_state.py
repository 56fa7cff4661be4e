"""Odometry beside `gnss_imu_filter`: it moves no state, and makes one less certain."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.filters.inertial_way import KeptFilter
from executive_plugins.estimation.filters.odometry_witness import OdometryWitness
from executive_plugins.estimation.filters.status_account import GLOBAL, SUSPECT
from executive_plugins.estimation.kalman.packed_queue import ROOM

from executive.geometry.pose import pose
from executive.messages.odometry import LidarIncrement

FROM_S, END_S = 14.0, 22.0
FAR = 14.2  # three standard deviations of three values
RATE = 0.05  # [m/s]


def drifting(stamp_s):
    return max(0.0, stamp_s - FROM_S) * RATE * np.array([0.8, 0.6, 0.0])


def position_nees(cabin, state):
    R = state.T_map_cabin[:3, :3]
    off = R.T @ (state.T_map_cabin - cabin.T_map_cabin(state.stamp_s))[:3, 3]
    return off @ np.linalg.solve(state.covariance[3:, 3:], off)


@pytest.fixture
def states(cabin, with_lidar, shifted, run, start):
    """Return the states of a swinging cabin, with fixes that drift or odometry that is wrong."""

    def states(has_odometry=True, shift=lambda _: np.zeros(3), way=1.0):
        observations = shifted(with_lidar(cabin, cabin.observations(END_S)), shift)
        some = []
        for one in observations:
            if isinstance(one, LidarIncrement):
                if not has_odometry:
                    continue
                if one.to_s > FROM_S:
                    T = one.T_from_to
                    one = replace(one, T_from_to=pose(T[:3, :3], way * T[:3, 3]))
            some.append(one)
        return run(start(standing={"is_used": False}), some)

    return states


def longest_s(cabin, states):
    """Return the longest time for which GLOBAL is said beyond three standard deviations."""
    longest, began_s = 0.0, None
    for state in states:
        is_wrong = state.status == GLOBAL and position_nees(cabin, state) > FAR
        began_s = (began_s or state.stamp_s) if is_wrong else None
        longest = max(longest, state.stamp_s - began_s if is_wrong else 0.0)
    return longest


def test_fixes_that_drift_are_held_by_the_covariance_with_odometry(cabin, states) -> None:
    assert longest_s(cabin, states(has_odometry=False, shift=drifting)) > 6.0
    assert longest_s(cabin, states(shift=drifting)) < 4.5


@pytest.mark.parametrize("way", [1.0, 0.5, 2.0])
def test_no_odometry_moves_a_state_or_ends_global(states, way) -> None:
    """Splitting the steps between samples changes the last digits alone."""
    without, beside = states(has_odometry=False), states(way=way)
    assert [one.status for one in beside] == [one.status for one in without]
    for one, other in zip(without, beside, strict=True):
        np.testing.assert_allclose(one.T_map_cabin, other.T_map_cabin, atol=1e-4)
    assert without[-1].status == GLOBAL


def test_a_doubt_lasts_for_as_long_as_odometry_shares_it(cabin, start, with_lidar) -> None:
    estimator = start()
    for one in with_lidar(cabin, cabin.observations(6.0)):
        estimator.add(one)
    now_s = estimator.state().stamp_s
    assert estimator.state().status == GLOBAL
    estimator._suspected_s = now_s - 9.99
    assert estimator.state().status == SUSPECT
    estimator._witnesses.compare = lambda: now_s
    increment = LidarIncrement(now_s - 0.1, now_s, "lidar_horizontal", np.eye(4), np.eye(6))
    estimator.add_odometry(increment)
    estimator._suspected_s = -np.inf
    assert estimator._status() == SUSPECT


def test_odometry_is_compared_outside_of_inertial_samples(cabin, start, with_lidar) -> None:
    """It takes longer than all else of a sample: what is kept waits for the next increment."""
    estimator, kept = start(), []
    for one in with_lidar(cabin, cabin.observations(6.0)):
        estimator.add(one)
        kept.append((isinstance(one, LidarIncrement), len(estimator._witnesses._waiting)))
    assert max(count for _, count in kept) == 1
    assert {count for is_increment, count in kept if is_increment} == {0}


def test_looks_take_no_room_from_the_corrections_that_wait(cabin, start, with_lidar) -> None:
    estimator = start()
    for one in with_lidar(cabin, cabin.observations(6.0)):
        estimator.add(one)
    trailing = estimator._trailing
    waiting = [one.place for one in trailing._corrections if one.place != ROOM - 1]
    assert sorted(trailing._free + waiting) == list(range(ROOM - 1))


def test_a_state_is_widened_by_the_stream_that_contradicts_it_most(
    cabin, start, with_lidar, run
) -> None:
    estimator = start()
    *_, state = run(estimator, with_lidar(cabin, cabin.observations(6.0)))
    witnesses = estimator._witnesses
    assert witnesses.widened(state) is state
    (known,) = witnesses._witnesses.values()
    increment = LidarIncrement(5.8, 5.9, "lidar_horizontal", np.eye(4), np.eye(6))
    for moved_m2 in (1.0, 4.0, 2.0):
        other = OdometryWitness(10.0, estimator._propagator)
        other.moved2, other.size2 = moved_m2 * np.eye(3), 3 * moved_m2
        witnesses._witnesses[f"lidar {moved_m2}"] = other
    witnesses.look(KeptFilter(estimator._trailing.kalman.block.copy(), 0), increment, False)
    witnesses.compare()
    added = witnesses.widened(state).covariance - state.covariance
    np.testing.assert_allclose(added[3:, 3:], 4.0 * np.eye(3), atol=1e-9)
    assert known.size2 < 1e-3


def test_odometry_of_no_sensor_of_the_cabin_is_ignored(estimator, cabin, run) -> None:
    *_, state = run(estimator, cabin.observations(4.0))
    before = state.stamp_s - 0.1
    one = LidarIncrement(before, state.stamp_s, "drone", np.eye(4), np.eye(6))
    estimator.add_odometry(one)
    assert not estimator.refused
