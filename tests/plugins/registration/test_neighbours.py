"""The cells' neighbours against all distances."""

import numpy as np
import pytest
from executive_plugins.registration.neighbours import neighbours_within
from scipy.spatial.distance import cdist


@pytest.mark.parametrize(("count", "radius_m"), [(1, 0.1), (400, 0.05), (400, 0.3), (400, 5.0)])
def test_finds_exactly_those_within_the_radius(count: int, radius_m: float) -> None:
    points = np.random.default_rng(count).uniform(-1, 1, (count, 3))
    queries = points[::3]
    starts, rows = neighbours_within(points, queries, radius_m)
    near = cdist(queries, points) <= radius_m
    assert len(rows) == near.sum()
    for i, row in enumerate(near):
        assert sorted(rows[starts[i] : starts[i + 1]]) == list(np.flatnonzero(row))


def test_points_at_one_place_are_all_neighbours() -> None:
    points = np.ones((50, 3))
    starts, rows = neighbours_within(points, points[:2], 0.1)
    assert list(starts) == [0, 50, 100]
    assert sorted(rows[:50]) == list(range(50))
