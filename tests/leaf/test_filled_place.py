"""A body at a stone's place is told from the ground, or the stones, that it stood on."""

import numpy as np
import pytest

from executive.geometry.pose import pose
from executive.leaf.filled_place import is_filled
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone, StoneState

X = np.arange(-0.5, 0.5, 0.05)


def top_at(height_m: float, shift_m: float = 0.0) -> np.ndarray:
    """Return a level square of one metre, shape (N, 3)."""
    xy = np.stack(np.meshgrid(X, X, indexing="ij"), -1).reshape(-1, 2)
    return np.column_stack([xy + (5.0 + shift_m, 2.0), np.full(len(xy), height_m)])


def stone() -> Stone:
    """Return a block whose seen surface is from 0.1 to 0.7 m high."""
    points = np.concatenate([top_at(0.7), top_at(0.1)[:20]])
    return Stone(1, StoneState.LOST, points, points.mean(axis=0), pose(), False)


@pytest.mark.parametrize(
    ("seen", "filled"),
    [
        (top_at(0.7), True),
        (top_at(0.7, shift_m=0.3), True),  # pushed
        (top_at(0.45), True),  # another stone lies there
        (top_at(0.0), False),  # the ground
        (top_at(0.7, shift_m=0.8), False),
        (np.zeros((0, 3)), False),
    ],
)
def test_most_of_the_place_is_as_high_as_half_of_the_stone(seen: np.ndarray, filled: bool) -> None:
    around = np.concatenate([seen, top_at(0.0, shift_m=0.0)])
    assert is_filled(Cloud("map", around), stone()) == filled
