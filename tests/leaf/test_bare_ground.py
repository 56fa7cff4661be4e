"""The ground below a structure: an even grid that reaches two metres beyond its foot."""

import numpy as np
import pytest

from executive.leaf.bare_ground import bare_ground
from executive.messages.structure import Structure

WALL = Structure("wall", np.array([[1.0, 0.0], [4.0, 0.0]]), thickness_m=1.0, height_m=1.0)


def grid_points(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return a point of a slope at each node of a grid of a quarter of a metre."""
    x, y = np.meshgrid(*(np.arange(low[k], high[k] + 0.01, 0.25) for k in (0, 1)), indexing="ij")
    return np.column_stack([x.ravel(), y.ravel(), 0.1 * x.ravel() - 0.2 * y.ravel()])


def test_a_slope_that_was_seen_whole_is_that_slope() -> None:
    low, high = WALL.bounds()
    grid, share = bare_ground(grid_points(low - 3.0, high + 3.0), WALL)
    assert share == 1.0
    assert grid.cell_m == 0.25
    assert grid.corner.tolist() == (low - 2.0).tolist()
    assert grid.heights.shape == tuple(np.round((high - low + 4.0) / 0.25).astype(int) + 1)
    last = grid.corner + 0.25 * (np.array(grid.heights.shape) - 1)
    assert last.tolist() == (high + 2.0).tolist()
    i, j = np.indices(grid.heights.shape)
    x, y = grid.corner[0] + 0.25 * i, grid.corner[1] + 0.25 * j
    assert np.allclose(grid.heights, 0.1 * x - 0.2 * y, atol=1e-12)


def test_points_of_one_cell_are_averaged_and_others_take_the_nearest_height() -> None:
    points = np.array([[1.0, 0.0, 1.0], [1.05, -0.05, 2.0], [4.0, 0.0, 5.0], [99.0, 0.0, 77.0]])
    grid, share = bare_ground(points, WALL)
    assert grid.at(np.array([[1.0, 0.0], [4.0, 0.0]])).tolist() == [1.5, 5.0]
    assert grid.at(np.array([[0.0, 1.0], [2.25, 0.0]])).tolist() == [1.5, 1.5]
    assert grid.at(np.array([[2.75, 0.0], [6.0, -1.0]])).tolist() == [5.0, 5.0]
    assert share == pytest.approx(2 / (13 * 5))  # nodes of a foot of 3 by 1 m


def test_without_a_point_near_it_the_ground_is_level_and_none_of_it_was_seen() -> None:
    for points in (np.empty((0, 3)), np.array([[99.0, 0.0, 77.0]])):
        grid, share = bare_ground(points, WALL)
        assert share == 0.0
        assert not grid.heights.any()
        assert grid.corner.tolist() == (WALL.bounds()[0] - 2.0).tolist()
