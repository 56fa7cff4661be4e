"""The voxel grid: what it keeps, and on what it depends."""

import numpy as np

from executive.geometry.voxels import voxel_means


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
