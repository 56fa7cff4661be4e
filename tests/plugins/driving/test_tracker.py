"""Steering along a straight path forwards and back again, by the law's own numbers."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.driving.tracker import Tracker

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.messages.drive import BasePath

UP = np.array([0.0, 0.0, 1.0])
LIMITS = SimpleNamespace(max_curvature_1_m=0.25, max_speed_m_s=1.0, max_acceleration_m_s2=0.4)
TRACKER = Tracker(LIMITS, 0.8, return_m=2.0)


def there_and_back() -> BasePath:
    """Return 4 m along x from the origin, and 3 m backwards along the same line."""
    x = np.concatenate([np.arange(41) / 10, 4.0 - np.arange(31) / 10])
    along_m = np.concatenate([np.arange(41) / 10, 4.0 + np.arange(31) / 10])
    poses = np.column_stack([x, np.zeros((len(x), 2))])
    curvature = np.where(np.arange(len(x)) < 41, 0.05, -0.05)
    return BasePath(poses, along_m, curvature, np.where(np.arange(len(x)) < 41, 1, -1))


def at(x: float, y: float = 0.0, yaw_rad: float = 0.0) -> Float:
    return pose(about_axis(UP, yaw_rad), np.array([x, y, 1.0]))


def test_on_its_path_it_drives_as_the_path_says() -> None:
    told = TRACKER.steer(there_and_back(), 0.9, at(1.02))
    assert (told.speed_m_s, told.curvature_1_m) == (0.8, pytest.approx(0.05))
    assert (told.along_m, told.off_m, told.left_m) == pytest.approx((1.02, 0.0, 5.98))


@pytest.mark.parametrize(
    ("y", "yaw_rad", "expected"),
    [
        (0.2, 0.0, 0.05 - 0.2 / 4.0),
        (-0.2, 0.0, 0.05 + 0.2 / 4.0),
        (0.0, 0.1, 0.05 - 0.1),
        (0.1, -0.1, 0.05 - 0.025 + 0.1),
        (3.0, 0.0, -0.25),  # as much as it can
        (-3.0, 0.0, 0.25),
    ],
)
def test_it_returns_by_distance_and_angle(y: float, yaw_rad: float, expected: float) -> None:
    told = TRACKER.steer(there_and_back(), 1.0, at(1.0, y, yaw_rad))
    assert told.curvature_1_m == pytest.approx(expected)
    assert told.off_m == pytest.approx(abs(y))


def test_backwards_the_angle_counts_the_other_way() -> None:
    told = TRACKER.steer(there_and_back(), 5.0, at(3.02, 0.04, 0.1))
    assert told.curvature_1_m == pytest.approx(-0.05 - 0.01 + 0.1)
    assert told.speed_m_s == -0.8
    assert (told.along_m, told.left_m) == pytest.approx((4.98, 2.02))


@pytest.mark.parametrize(
    ("left_m", "expected"),
    [
        (2.0, 0.8),
        (1.0, np.sqrt(0.4 * 1.0)),  # braking with half of what it can
        (0.1, 0.2),
        (0.031, np.sqrt(0.4 * 0.031)),
        (0.029, 0.0),
    ],
)
def test_it_brakes_before_an_end(left_m: float, expected: float) -> None:
    told = TRACKER.steer(there_and_back(), 4.0 - left_m, at(4.0 - left_m))
    assert told.speed_m_s == pytest.approx(expected)


def test_near_an_end_it_creeps_and_top_speed_is_the_machine_s() -> None:
    slow = SimpleNamespace(**vars(LIMITS) | {"max_acceleration_m_s2": 0.01})
    told = Tracker(slow, 0.8, 2.0).steer(there_and_back(), 3.5, at(3.5))
    assert told.speed_m_s == 0.1
    weak = SimpleNamespace(**vars(LIMITS) | {"max_speed_m_s": 0.3})
    assert Tracker(weak, 0.8, 2.0).steer(there_and_back(), 1.0, at(1.0)).speed_m_s == 0.3


def test_at_the_end_of_a_piece_the_next_begins_and_the_last_ends_the_path() -> None:
    path = there_and_back()
    told = TRACKER.steer(path, 3.9, at(3.98))
    assert (told.speed_m_s, told.along_m, told.left_m) == (0.0, 4.0, 3.0)
    told = TRACKER.steer(path, told.along_m, at(3.98))
    assert told.speed_m_s == -0.8
    assert told.along_m == pytest.approx(4.02)
    told = TRACKER.steer(path, 6.9, at(1.02))
    assert (told.speed_m_s, told.along_m, told.left_m) == (0.0, 7.0, 0.0)
    # Beyond an end it is at the end.
    assert TRACKER.steer(path, 3.9, at(4.3)).along_m == 4.0


def test_it_is_looked_for_about_its_last_place() -> None:
    """Half a metre back to two ahead: a machine cannot be elsewhere on its path."""
    path = there_and_back()
    assert TRACKER.steer(path, 1.0, at(0.6)).along_m == pytest.approx(0.6)
    behind = TRACKER.steer(path, 1.0, at(0.1, 0.3))
    assert behind.along_m == pytest.approx(0.1)
    assert behind.off_m == pytest.approx(0.3)
    turned = TRACKER.steer(path, 1.0, at(0.1, 0.3))
    assert turned.curvature_1_m == pytest.approx(0.05 - 0.3 / 4.0)
    # The nearest sample of the piece that it is on, though the other passes the same place.
    assert TRACKER.steer(path, 3.0, at(3.0)).speed_m_s > 0
    assert TRACKER.steer(path, 5.0, at(3.0)).speed_m_s < 0
