"""Increments of odometry as one chain of poses."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Increment
from executive_plugins.estimation.graph.lidar_chain import LidarChain

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy

STEP = pose(from_rpy(0.0, 0.0, np.pi / 2), np.array([3.0, 4.0, 0.0]))


def increment(from_s: float, stamp_s: float) -> Increment:
    return Increment(from_s, stamp_s, STEP, np.eye(6))


def chain(count: int, period_s: float = 0.1) -> LidarChain:
    made = LidarChain()
    for k in range(count):
        made.add(increment(k * period_s, (k + 1) * period_s))
    return made


def test_increments_are_composed_in_the_frame_of_the_first() -> None:
    made = chain(2)
    stamp_s, where = made.newest()
    assert stamp_s == pytest.approx(0.2)
    assert where == pytest.approx(STEP @ STEP)
    assert (made.begun, made.way_m) == (1, 10.0)


def test_a_break_begins_a_chain_at_its_own_first_scan_and_keeps_the_way() -> None:
    made = chain(3)
    made.add(increment(0.5, 0.6))
    assert made.newest()[1] == pytest.approx(STEP)
    assert (made.begun, made.way_m) == (2, 20.0)
    assert made.before(0.55, 1.0)[0] == 0.5
    assert made.before(0.45, 1.0) is None
    made.add(increment(0.6004, 0.7))  # stamps that differ by less than the rounding
    assert made.begun == 2
    made.add(increment(0.7006, 0.8))
    assert made.begun == 3


def test_the_last_scan_before_a_time_is_found_unless_it_is_too_old() -> None:
    made = chain(3)
    stamp_s, where = made.before(0.25, 0.06)
    assert stamp_s == pytest.approx(0.2)
    assert where == pytest.approx(STEP @ STEP)
    assert made.before(0.25, 0.04) is None
    assert made.before(made.newest()[0], 0.0)[0] == made.newest()[0]
    assert made.before(-0.01, 9.0) is None


def test_five_seconds_are_kept() -> None:
    made = chain(8, period_s=1.0)
    assert made.before(3.5, 9.0)[0] == 3.0
    assert made.before(2.5, 9.0) is None


def test_before_the_first_increment_there_is_nothing() -> None:
    made = LidarChain()
    assert made.newest() is None
    assert made.before(1.0, 9.0) is None
    assert (made.begun, made.way_m) == (0, 0.0)
