"""One point of each square, seen from above."""

import numpy as np
from executive_plugins.segmentation.even_sample import first_in_squares


def test_a_dense_stone_gives_no_more_points_than_its_area() -> None:
    rng = np.random.default_rng(0)
    ground = np.column_stack([rng.uniform(0, 10, (3000, 2)), np.zeros(3000)])
    stone = np.column_stack([rng.uniform(4, 5, (5000, 2)), np.full(5000, 0.4)])
    found = first_in_squares(np.vstack([stone, ground]), 1.0)
    assert len(found) == 100
    assert (found[:, 2] == 0.4).sum() <= 4
    cells = np.floor(found[:, :2] - np.vstack([stone, ground]).min(axis=0)[:2])
    assert len(np.unique(cells, axis=0)) == 100


def test_points_that_are_far_apart_are_all_kept_in_their_order() -> None:
    points = np.array([[9.0, 0.0, 1.0], [0.0, 9.0, 2.0], [0.0, 0.0, 3.0]])
    np.testing.assert_array_equal(first_in_squares(points, 1.0), points)
