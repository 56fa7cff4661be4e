"""How far a held stone is above what was seen below it."""

import numpy as np
import pytest

from executive.geometry.pose import pose
from executive.messages.ground_below import ground_below

HELD = np.array([[0.4, 0.0, -0.6], [-0.4, 0.3, 0.2]])  # reaches 0.5 m away and 0.6 m down


def ground(*more: tuple[float, float, float], without: float = 0.0) -> np.ndarray:
    """Return level ground of 10 m about the origin, without a square in its middle, and points."""
    x = np.arange(-5.0, 5.0, 0.1)
    xy = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    xy = xy[(np.abs(xy) >= without).any(axis=1)]
    return np.vstack([np.column_stack([xy, np.zeros(len(xy))]), *more])


def at(x: float, y: float, z: float) -> np.ndarray:
    return pose(t=np.array([x, y, z]))


def test_the_lowest_point_of_the_stone_counts() -> None:
    below = ground_below(ground(), np.eye(4), HELD, at(3.0, 0.0, 1.0))
    assert below.clearance_m(at(-3.0, 1.0, 2.0)) == pytest.approx(1.4)


def test_what_stands_under_any_part_of_the_stone_counts() -> None:
    below = ground_below(ground((2.0, 0.0, 0.9)), np.eye(4), HELD, at(0.0, 0.0, 1.0))
    assert below.clearance_m(at(1.6, 0.0, 2.0)) == pytest.approx(0.5)
    assert below.clearance_m(at(0.9, 0.0, 2.0)) == pytest.approx(1.4)


@pytest.mark.parametrize("place", [(0.0, 0.0), (4.9, 0.0), (20.0, 0.0), (-20.0, 0.0)])
def test_nothing_is_told_over_what_was_not_seen(place: tuple[float, float]) -> None:
    below = ground_below(ground(without=0.5), np.eye(4), HELD, at(3.0, 0.0, 1.0))
    assert below.clearance_m(at(*place, 9.0)) < -1e5


def test_an_empty_map_tells_nothing() -> None:
    below = ground_below(np.zeros((0, 3)), np.eye(4), HELD, at(3.0, 0.0, 1.0))
    assert below.clearance_m(at(0.0, 0.0, 9.0)) < -1e5
