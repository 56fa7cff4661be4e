"""Measurements that come late are used at their own time, and a lag that is too short grows."""

from typing import Any

import numpy as np
import pytest
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.trailing_filter import Correction, TrailingFilter
from executive_plugins.estimation.live.layout import SAMPLE

Z = np.zeros(3)
UP = np.array([0.0, 0.0, 9.81])
NOISE = InertialNoise(1e-4, 1e-3, 1e-6, 1e-5, 1e-2, 9.81, 0.01)


class Told:
    """What the propagator was told, with the time of each state [s], and its samples."""

    def __init__(self) -> None:
        self.taken: list[float] = []
        self.anchored: list[float] = []
        self.samples, self.ring = 0, np.zeros(300, SAMPLE)

    def step(self, stamp_s: float) -> None:
        self.ring[self.samples % len(self.ring)] = stamp_s, 0.01, Z, UP
        self.samples += 1

    def take(self, row: Any) -> None:
        self.taken.append(float(row["sample"]["stamp_s"][0]))

    def anchor(self, row: Any) -> None:
        self.anchored.append(float(row["sample"]["stamp_s"][0]))


class Trail:
    """A body at rest since 10 s, sampled every 10 ms, its filter 0.1 s behind."""

    def __init__(self) -> None:
        self.told, self.applied = Told(), []
        start = InertialState(Inertial(10.0, Z, UP, 0.01), np.eye(3), Z, Z, Z, Z)
        self.kalman = ErrorStateFilter(start, 1e-4 * np.eye(15), NOISE)
        self.trailing = TrailingFilter(self.kalman, 0.1, self.told)
        self.k = 0

    def until(self, stamp_s: float) -> None:
        while 10.0 + (self.k + 1) / 100 <= stamp_s + 1e-9:
            self.k += 1
            self.told.step(10.0 + self.k / 100)
            self.trailing.add_sample(10.0 + self.k / 100)

    def add(self, stamp_s: float) -> bool:
        def apply() -> None:
            self.applied.append((stamp_s, self.kalman.state.stamp_s))

        return self.trailing.add(Correction(stamp_s, apply))


def test_corrections_are_applied_at_their_own_time_and_in_order() -> None:
    trail = Trail()
    trail.until(10.3)
    assert all(trail.add(stamp_s) for stamp_s in (10.285, 10.225, 10.253))
    assert not trail.applied
    trail.until(10.36)
    assert [stamp_s for stamp_s, _ in trail.applied] == [10.225, 10.253]
    trail.until(10.5)
    assert [stamp_s for stamp_s, _ in trail.applied] == [10.225, 10.253, 10.285]
    for stamp_s, at_s in trail.applied:
        assert at_s == pytest.approx(stamp_s)


def test_the_filter_steps_through_several_samples_at_once_and_through_all_on_request() -> None:
    trail, stamps_s = Trail(), set()
    trail.trailing.follow()  # there is no sample yet
    for k in range(1, 51):
        trail.until(10.0 + k / 100)
        stamps_s.add(round(trail.kalman.state.stamp_s, 4))
        assert k <= 10 or 10.0 + k / 100 - max(stamps_s) == pytest.approx(0.125, abs=0.0251)
    assert len(stamps_s) <= 11  # 50 samples, of which 10 lie within the lag
    trail.trailing.follow()
    assert trail.kalman.state.stamp_s == pytest.approx(10.4)
    assert trail.add(10.405)
    trail.until(10.51)
    assert [stamp_s for stamp_s, _ in trail.applied] == [10.405]


def test_two_corrections_of_one_moment_are_both_applied() -> None:
    trail = Trail()
    assert trail.add(10.05)
    assert trail.add(10.05)
    trail.until(10.2)
    assert [stamp_s for stamp_s, _ in trail.applied] == [10.05, 10.05]


def test_the_first_state_holds_what_was_measured_before_it() -> None:
    trail = Trail()
    assert trail.add(9.5)
    assert trail.add(10.0)
    trail.until(11.0)
    assert not trail.applied


@pytest.mark.parametrize(("late_s", "lag_s"), [(0.5, 0.6), (1.9, 2.0)])
def test_what_is_too_late_is_told_and_the_next_is_in_time(late_s: float, lag_s: float) -> None:
    trail = Trail()
    trail.until(13.0)
    assert not trail.add(13.0 - late_s)
    assert trail.kalman.state.stamp_s == pytest.approx(12.9)
    trail.until(13.0 - 0.1 + lag_s)  # the filter waits where it is until it trails by so much
    assert trail.kalman.state.stamp_s == pytest.approx(12.9)
    trail.until(15.0)
    assert trail.kalman.state.stamp_s == pytest.approx(15.0 - lag_s)
    assert trail.add(15.0 - late_s)
    trail.until(15.2)
    assert [stamp_s for stamp_s, _ in trail.applied] == [15.0 - late_s]


def test_the_propagator_gets_corrections_at_once_and_else_twenty_covariances_a_second() -> None:
    trail = Trail()
    assert trail.told.taken == [10.0]
    trail.until(11.0)
    assert trail.told.taken == [10.0]
    assert len(trail.told.anchored) == 20
    trail.add(10.95)
    trail.until(11.05)
    assert trail.told.taken[1:] == pytest.approx([10.95])
