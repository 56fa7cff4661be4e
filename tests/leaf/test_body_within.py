"""A body that may be a lost stone is told from ground, from noise, and from what is elsewhere."""

import numpy as np
import pytest

from executive.geometry.pose import pose
from executive.leaf.body_within import body_within
from executive.messages.height_grid import HeightGrid
from executive.messages.stone import Stone, StoneState
from executive.messages.structure import Structure

WALL = Structure("wall", np.array([[-3.0, 6.0], [3.0, 6.0]]), 1.4, 1.0)
GROUND = HeightGrid(np.array([-6.0, 3.0]), 1.0, np.zeros((13, 7)))
RNG = np.random.default_rng(4)


def box(at: tuple, sides: tuple = (0.8, 0.8, 0.6)) -> np.ndarray:
    """Return points of the upper side and the flanks of a block that stands at a place."""
    points = RNG.uniform(-0.5, 0.5, (1500, 3))
    face = RNG.integers(0, 5, len(points))
    points[face < 2, 0] = np.where(face[face < 2] == 0, -0.5, 0.5)
    points[(face >= 2) & (face < 4), 1] = np.where(face[(face >= 2) & (face < 4)] == 2, -0.5, 0.5)
    points[face == 4, 2] = 0.5
    return np.asarray((points + (0.0, 0.0, 0.5)) * sides + at)


def lost() -> Stone:
    points = box((0.0, 6.0, 0.0))
    return Stone(7, StoneState.LOST, points, points.mean(axis=0), pose(), False)


@pytest.mark.parametrize(
    ("seen", "is_body"),
    [
        (box((0.9, 6.0, 0.0)), True),
        (box((0.3, 6.0, 0.5)), True),  # on others
        (box((0.9, 6.0, 0.0), (0.8, 0.8, 0.1)), False),  # as low as rough ground
        (box((0.9, 6.0, 0.0), (0.3, 0.3, 0.6)), False),  # too small
        (box((0.9, 8.0, 0.0)), False),  # beside the structure
        (np.empty((0, 3)), False),
    ],
)
def test_a_body_in_the_foot_may_be_the_stone(seen: np.ndarray, is_body: bool) -> None:
    ground = np.column_stack([RNG.uniform((-2, 4), (2, 8), (500, 2)), np.zeros(500)])
    found = body_within(np.concatenate([seen, ground]), lost(), WALL, GROUND)
    assert (found is not None) == is_body
    if found is not None:
        assert found.stone.name == "7"
        np.testing.assert_allclose(found.vertices_map().max(axis=0), seen.max(axis=0), atol=0.01)


def test_of_two_bodies_the_larger_one_is_taken() -> None:
    small, large = box((-1.5, 6.0, 0.0), (0.6, 0.6, 0.6)), box((1.0, 6.0, 0.0))
    found = body_within(np.concatenate([small, large]), lost(), WALL, GROUND)
    assert found is not None
    assert found.T_map_stone[0, 3] == pytest.approx(1.0, abs=0.1)


def test_what_is_flat_has_no_volume() -> None:
    seen = box((0.9, 6.0, 0.0))
    seen[:, 2] = 0.5
    assert body_within(seen, lost(), WALL, GROUND) is None
