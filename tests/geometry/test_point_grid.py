"""Nearest points by cells against all distances."""

import numpy as np
import pytest

from executive.arrays import Float
from executive.geometry.point_grid import PointGrid


def cloud(seed: int, count: int, spread_m: float = 3.0) -> Float:
    return np.random.default_rng(seed).uniform(-spread_m, spread_m, (count, 3)) * [1, 1, 0.2]


def all_distances(queries: Float, points: Float) -> Float:
    return np.asarray(np.linalg.norm(queries[:, None] - points, axis=2))


@pytest.mark.parametrize("cell_m", [0.05, 0.3, 2.0, 50.0])
@pytest.mark.parametrize("reach_m", [0.2, 1.0, np.inf])
def test_finds_the_nearest_point_within_reach(cell_m: float, reach_m: float) -> None:
    points, queries = cloud(1, 400), cloud(2, 300, 5.0)
    distances, rows = PointGrid(points, cell_m).nearest(queries, reach_m)
    wanted = all_distances(queries, points)
    is_near = wanted.min(axis=1) < reach_m
    assert np.allclose(distances[is_near], wanted.min(axis=1)[is_near], atol=1e-12)
    assert np.array_equal(rows[is_near], wanted.argmin(axis=1)[is_near])
    assert np.isinf(distances[~is_near]).all()
    assert (rows[~is_near] == len(points)).all()


def test_finds_the_distances_of_several_neighbours() -> None:
    points = cloud(3, 200)
    found = PointGrid(points, 0.4).distances_m(points, 6)
    assert np.allclose(found, np.sort(all_distances(points, points), axis=1)[:, :6], atol=1e-12)


def test_fewer_points_than_asked_for_are_infinitely_far() -> None:
    found = PointGrid(np.zeros((2, 3)), 0.4).distances_m(np.array([[3.0, 4.0, 0.0]]), 4)
    assert found.tolist() == [[5.0, 5.0, np.inf, np.inf]]


def test_a_set_without_points_has_no_nearest() -> None:
    distances, rows = PointGrid(np.empty((0, 3)), 0.4).nearest(np.zeros((1, 3)), 1.0)
    assert np.isinf(distances[0])
    assert rows[0] == 0


def test_points_at_the_reach_are_none() -> None:
    assert np.isinf(PointGrid(np.zeros((1, 3)), 1.0).nearest(np.array([[0, 0, 1.0]]), 1.0)[0][0])


def test_a_wide_set_gets_coarser_cells() -> None:
    points = np.array([[0.0, 0, 0], [1e5, 0, 0], [0, 1e5, 3.0]])
    distances, rows = PointGrid(points, 0.1).nearest(points + [0.5, 0, 0], 1.0)
    assert distances.tolist() == [0.5, 0.5, 0.5]
    assert rows.tolist() == [0, 1, 2]
