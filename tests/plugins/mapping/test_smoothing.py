"""Smoothing over neighbouring voxels, against a search among all points."""

import numpy as np
import pytest
from executive_plugins.mapping.voxel_grid import VoxelGrid


def by_search(means: np.ndarray, counts: np.ndarray, reach_m: float) -> np.ndarray:
    squares = ((means[:, None] - means[None]) ** 2).sum(axis=2)
    weights = np.maximum(1 - squares / reach_m**2, 0) * counts
    return weights @ means / weights.sum(axis=1)[:, None]


@pytest.mark.parametrize("reach_m", [0.03, 0.07, 0.099])
def test_it_is_the_weighted_mean_of_all_points_in_reach(reach_m: float) -> None:
    grid = VoxelGrid(0.1, memory=10**6)
    grid.insert(np.random.default_rng(0).normal(0, 0.25, (6000, 3)))
    means, counts = grid.points()
    moved, same_counts = grid.surface(reach_m)
    np.testing.assert_array_equal(same_counts, counts)
    np.testing.assert_allclose(moved, by_search(means, counts, reach_m), atol=1e-12)
    assert np.abs(moved - means).max() > 1e-4


def test_layers_of_noise_are_merged_into_the_surface() -> None:
    rng = np.random.default_rng(0)
    grid = VoxelGrid(0.03, memory=1000)
    sheet = np.column_stack([rng.uniform(0, 1, (60_000, 2)), np.full(60_000, 0.017)])
    grid.insert(sheet + rng.normal(0, [0, 0, 0.02], sheet.shape))
    raw, counts = grid.points()
    smooth, _ = grid.surface(0.045)
    assert np.std(raw[counts > 1, 2]) > 0.02
    assert np.average(np.abs(smooth[:, 2] - 0.017), weights=counts) < 0.009  # of 16 mm


def test_a_ball_keeps_its_size() -> None:
    rng = np.random.default_rng(0)
    d = rng.normal(size=(200_000, 3))
    grid = VoxelGrid(0.03, memory=1000)
    grid.insert(0.4 * d / np.linalg.norm(d, axis=1)[:, None] + 0.5)
    radii = np.linalg.norm(grid.surface(0.045)[0] - 0.5, axis=1)
    assert radii.mean() == pytest.approx(0.4, abs=0.002)  # reach² / (8 · radius) = 0.6 mm
