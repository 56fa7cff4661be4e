"""Smoothing over neighbouring voxels, against a search among all points."""

import numpy as np
import pytest
from executive_plugins.mapping.cylinder import Cylinder
from executive_plugins.mapping.map_cloud import MapCloud
from executive_plugins.mapping.settings import VoxelMapSettings
from executive_plugins.mapping.voxel_grid import VoxelGrid


def by_search(means: np.ndarray, counts: np.ndarray, reach_m: float) -> np.ndarray:
    squares = ((means[:, None] - means[None]) ** 2).sum(axis=2)
    weights = np.maximum(1 - squares / reach_m**2, 0) * counts
    return weights @ means / weights.sum(axis=1)[:, None]


def thinned(points: np.ndarray, voxel_m: float) -> np.ndarray:
    cells, place = np.unique(np.floor(points / voxel_m), axis=0, return_inverse=True)
    sums = np.zeros_like(cells)
    np.add.at(sums, place.ravel(), points)
    return sums / np.bincount(place.ravel())[:, None]


def surface(grid: VoxelGrid, voxel_m: float, reach_m: float, least: int = 1) -> np.ndarray:
    settings = VoxelMapSettings(
        voxel_m=voxel_m, smoothing_m=reach_m, min_points=least, memory=10**6
    )
    return MapCloud(settings).cloud(grid, Cylinder(settings.radius_m)).points


@pytest.mark.parametrize("reach_m", [0.0, 0.03, 0.07, 0.099])
@pytest.mark.parametrize("least", [1, 3])
def test_it_is_the_weighted_mean_of_all_points_in_reach(reach_m: float, least: int) -> None:
    grid = VoxelGrid(0.1, memory=10**6)
    grid.insert(np.random.default_rng(0).normal(0, 0.25, (6000, 3)))
    means, counts = grid.points()
    moved = by_search(means, counts, reach_m) if reach_m else means
    found = surface(grid, 0.1, reach_m, least)
    np.testing.assert_allclose(found, thinned(moved[counts >= least], 0.1), atol=1e-12)


def test_points_beyond_the_cylinder_are_left_out() -> None:
    grid = VoxelGrid(0.1, memory=1)
    grid.insert(np.array([[9.95, 0.05, 0.05], [10.05, 0.05, 0.05], [0.05, 0.05, -10.05]]))
    np.testing.assert_allclose(surface(grid, 0.1, 0.0), [[9.95, 0.05, 0.05]])


def test_layers_of_noise_are_merged_into_the_surface() -> None:
    rng = np.random.default_rng(0)
    grid = VoxelGrid(0.03, memory=1000)
    sheet = np.column_stack([rng.uniform(0, 1, (60_000, 2)), np.full(60_000, 0.017)])
    grid.insert(sheet + rng.normal(0, [0, 0, 0.02], sheet.shape))
    raw, counts = grid.points()
    smooth = surface(grid, 0.03, 0.045, 2)
    assert np.std(raw[counts > 1, 2]) > 0.02
    assert np.std(smooth[:, 2]) < 0.75 * np.std(raw[counts > 1, 2])
    assert len(smooth) < 0.7 * (counts > 1).sum()


def test_a_ball_keeps_its_size() -> None:
    rng = np.random.default_rng(0)
    d = rng.normal(size=(200_000, 3))
    grid = VoxelGrid(0.03, memory=1000)
    grid.insert(0.4 * d / np.linalg.norm(d, axis=1)[:, None] + 0.5)
    radii = np.linalg.norm(surface(grid, 0.03, 0.045) - 0.5, axis=1)
    assert radii.mean() == pytest.approx(0.4, abs=0.002)  # reach² / (8 · radius) = 0.6 mm
