"""The voxel grid: what it keeps, and on what it depends."""

import numpy as np
import pytest

from executive.geometry.radix_sort import radix_order, radix_sorted
from executive.geometry.voxels import first_in_cells, voxel_means


def test_each_occupied_cell_gives_the_mean_of_its_points() -> None:
    points = np.array([[0.1, 0.1, 0.1], [0.3, 0.1, 0.1], [1.5, 0.2, 0.2], [-0.5, 0.0, 0.0]])
    np.testing.assert_allclose(
        voxel_means(points, 1.0), [[-0.5, 0, 0], [0.2, 0.1, 0.1], [1.5, 0.2, 0.2]]
    )


def test_the_order_of_the_points_does_not_matter() -> None:
    rng = np.random.default_rng(0)
    points = rng.normal(0, 3, (2000, 3))
    np.testing.assert_allclose(
        voxel_means(points, 0.5), voxel_means(rng.permutation(points), 0.5), atol=1e-12
    )


def test_no_points_give_no_points() -> None:
    assert voxel_means(np.zeros((0, 3)), 0.1).shape == (0, 3)


def test_a_grid_finer_than_the_points_keeps_them_all() -> None:
    points = np.random.default_rng(1).uniform(-50, 50, (500, 3))
    assert len(voxel_means(points, 1e-3)) == 500


def test_thinning_leaves_one_point_in_each_cell_and_keeps_the_mean() -> None:
    points = np.random.default_rng(0).uniform(0, 1, (20000, 3))
    thin = voxel_means(points, 0.25)
    assert len(thin) == 64
    np.testing.assert_allclose(thin.mean(axis=0), points.mean(axis=0), atol=0.01)
    np.testing.assert_allclose(voxel_means(np.repeat(points, 3, axis=0), 0.25), thin)


def test_the_first_point_of_each_cell_is_found() -> None:
    points = np.array([[0.9, 0.1], [-0.2, 0.3], [0.1, 0.8], [-0.1, 0.9], [1.2, 0.0]])
    np.testing.assert_array_equal(first_in_cells(points, 1.0), [1, 0, 4])


def test_every_point_shares_a_cell_with_one_that_was_kept() -> None:
    points = np.random.default_rng(2).normal(0, 3, (500, 3))
    kept = points[first_in_cells(points, 0.7)]
    cells, of_kept = (set(map(tuple, np.floor(p / 0.7))) for p in (points, kept))
    assert cells == of_kept
    assert len(kept) == len(cells)


def test_a_grid_may_begin_at_a_corner() -> None:
    points = np.array([[0.75, 0, 0], [1.25, 0, 0], [2.0, 0, 0]])
    shifted = voxel_means(points, 1.0, corner=np.array([0.5, 0, 0]))
    np.testing.assert_allclose(shifted, [[1.0, 0, 0], [2.0, 0, 0]])
    np.testing.assert_allclose(voxel_means(points, 1.0), [[0.75, 0, 0], [1.25, 0, 0], [2.0, 0, 0]])


def test_the_means_are_those_of_sorting_all_cells() -> None:
    points = np.random.default_rng(3).normal(0.0, 3.0, (2000, 3))
    rows = np.unique(np.floor(points / 0.5), axis=0, return_inverse=True)[1]
    rows = rows.reshape(-1)
    sums = np.stack([np.bincount(rows, weights=points[:, a]) for a in range(3)], axis=1)
    expected = sums / np.bincount(rows)[:, None]
    np.testing.assert_array_equal(voxel_means(points, 0.5), expected)


@pytest.mark.parametrize("bits", [3, 40, 52, 53, 54, 62])
def test_keys_of_many_digits_are_sorted_and_equal_ones_keep_their_order(bits: int) -> None:
    """With 500 rows, keys of 53 bits leave room for their rows, and longer ones do not."""
    keys = np.random.default_rng(4).integers(0, 1 << bits, 500)
    keys[100:200] = keys[:100]
    np.testing.assert_array_equal(radix_order(keys), np.argsort(keys, kind="stable"))
    np.testing.assert_array_equal(radix_sorted(keys)[0], np.sort(keys))
    assert len(radix_order(keys[:0])) == 0
