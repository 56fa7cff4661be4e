"""A hold that ends tells how long it was and how far the estimate moved meanwhile."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.mission.hold import Hold


def state(x: float, y: float, yaw_rad: float) -> SimpleNamespace:
    return SimpleNamespace(T_map_base=pose(from_rpy(0.0, 0.0, yaw_rad), np.array([x, y, 1.0])))


def test_the_end_of_a_hold_is_told_with_its_time_and_the_motion_of_the_estimate() -> None:
    hold = Hold("no fix", 10.25, state(1.0, 2.0, 0.5))
    event = hold.ended(13.5000004, state(1.3, 2.4, 0.7), "a fix is there")
    assert (event.held_s, event.reason) == (3.25, "a fix is there")
    assert event.moved_m == pytest.approx(0.5)
    assert event.turned_rad == pytest.approx(0.2)
