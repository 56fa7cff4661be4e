"""All corrections of a sample in one compiled call do what one call for each does, to the bit."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.kalman import queued_filter
from executive_plugins.estimation.kalman.queued_filter import QueuedFilter
from executive_plugins.estimation.kalman.trailing_filter import TrailingFilter

from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample


class OneByOne(GnssImuFilter):
    """Calls compiled code for each correction."""

    def _new_trailing(self, kalman, _):
        return TrailingFilter(kalman, self._settings.lag_s, self._propagator)


def wrong(observation, k):
    """Let a fix in twenty be far away, all jump for a while, and some come very late."""
    if not isinstance(observation, GnssFix) or observation.stamp_s < 4.0:
        return observation
    is_off = k % 20 == 0 or 12.0 < observation.stamp_s < 12.5
    off = np.array([2e-7, 0.0, 0.0]) if is_off else np.zeros(3)
    return replace(observation, geodetic=observation.geodetic + off)


def feed(estimator, observations, is_sound):
    """Return the bytes of all states, and the trailing filter's kind."""
    said = []
    for k, observation in enumerate(observations):
        estimator.add(observation if is_sound else wrong(observation, k))
        if isinstance(observation, ImuSample) and observation.frame == "imu_cabin":
            state = estimator.state()
            arrays = state.T_map_cabin, state.T_odom_base, state.v_map_cabin, state.covariance
            said.append((state.stamp_s, state.status, *(one.tobytes() for one in arrays)))
    return said


@pytest.mark.parametrize("is_sound", [True, False])
def test_states_and_their_account_are_the_same_to_the_bit(machine, cabin, is_sound) -> None:
    answers = []
    for kind in (GnssImuFilter, OneByOne):
        estimator = kind(kind.Settings(), machine)
        estimator.start()
        states = feed(estimator, cabin.observations(15.0), is_sound)
        answers.append((states, estimator.account(), estimator.refused))
        assert isinstance(estimator._trailing, QueuedFilter) == (kind is GnssImuFilter)
    assert answers[0] == answers[1]
    assert {status for _, status, *_ in answers[0][0]} >= {"GLOBAL"}
    assert bool(answers[0][2]) != is_sound  # some of the wrong fixes are refused


def test_odometry_looks_at_the_same_filter_to_the_bit(machine, cabin, with_lidar, shifted) -> None:
    """Fixes that drift by 5 cm/s draw the filter along, and odometry widens its state."""

    def drifting(stamp_s):
        return np.array([0.05 * max(0.0, stamp_s - 5.0), 0.0, 0.0])

    observations = list(shifted(with_lidar(cabin, cabin.observations(14.0)), drifting))
    answers = []
    for kind in (GnssImuFilter, OneByOne):
        estimator = kind(kind.Settings(standing={"is_used": False}), machine)
        estimator.start()
        answers.append(feed(estimator, observations, is_sound=True))
        assert estimator._witnesses._widest is not None
    assert answers[0] == answers[1]


def test_states_that_were_handed_out_do_not_change(cabin, start) -> None:
    estimator, kept = start(), []
    for observation in cabin.observations(5.0):
        estimator.add(observation)
        if isinstance(observation, ImuSample):
            state = estimator.state()
            kept.append((state, state.T_map_cabin.copy()))
            if estimator._trailing is not None:
                estimator._trailing.follow()
    assert all(np.array_equal(state.T_map_cabin, T) for state, T in kept)


def test_corrections_without_room_are_applied_one_by_one(machine, cabin, monkeypatch) -> None:
    """Fixes of 0.6 s at 20 Hz are more than there is room for here."""
    monkeypatch.setattr(queued_filter, "ROOM", 8)
    monkeypatch.setattr(queued_filter, "_APART", 7)
    answers = []
    for kind in (GnssImuFilter, OneByOne):
        estimator = kind(kind.Settings(lag_s=0.6), machine)
        estimator.start()
        answers.append(feed(estimator, cabin.observations(8.0), is_sound=True))
    assert answers[0] == answers[1]
