"""A map's cloud that is brought up to date, beside one that is made anew."""

from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.mapping.cylinder import Cylinder
from executive_plugins.mapping.map_cloud import MapCloud
from executive_plugins.mapping.settings import VoxelMapSettings
from executive_plugins.mapping.voxel_grid import VoxelGrid

SETTINGS = VoxelMapSettings(voxel_m=0.1, smoothing_m=0.15, radius_m=6.0, min_points=2)
CYLINDER = Cylinder(6.0)


def site(rng: np.random.Generator, count: int = 4000) -> np.ndarray:
    """Ground, a tall wall, and points in the air."""
    u, v = rng.uniform(-3, 3, (2, count))
    ground = np.column_stack([u, v, 0.05 * np.sin(3 * u)])
    wall = np.column_stack([np.full(count, 1.23), v, 0.8 * (u + 3)])
    return np.vstack([ground, wall, rng.uniform(-3, 3, (50, 3))]) + rng.normal(0, 0.02, 3)


def changes(rng: np.random.Generator) -> list[Callable[[VoxelGrid], object]]:
    def insert(count: int, shift_m: float) -> Callable[[VoxelGrid], object]:
        points = site(rng)[:: max(8000 // count, 1)] + [shift_m, 0.0, 0.0]
        return lambda grid: grid.insert(points)

    corners = rng.integers(-30, 30, (40, 3))
    return [
        insert(8000, 0.0),
        insert(300, 0.0),
        lambda grid: None,
        insert(2000, 0.5),
        lambda grid: grid.erase(corners, 4),
        lambda grid: grid.forget_sphere(np.array([1.0, 0.5, 0.3]), 1.0, 2),
        insert(8000, 0.0),
        lambda grid: grid.keep(grid.points()[0][:, 0] < 2.0),
        insert(8000, 2.5),  # beyond the columns that were laid out
        lambda grid: grid.refill(*(part[::2] for part in grid.rows())),
        insert(200, 0.0),
    ]


@pytest.mark.parametrize("seed", range(5))
def test_it_has_the_bits_of_one_that_is_made_anew(seed: int) -> None:
    grid, kept = VoxelGrid(0.1, 100), MapCloud(SETTINGS)
    for change in changes(np.random.default_rng(seed)):
        change(grid)
        twin = VoxelGrid(0.1, 100)
        twin.refill(*grid.rows())
        found = kept.cloud(grid, CYLINDER).points
        np.testing.assert_array_equal(found, MapCloud(SETTINGS).cloud(twin, CYLINDER).points)
        assert len(found) > 500


def test_a_change_that_is_not_noted_is_not_read() -> None:
    """What the bookkeeping leaves out stays as it was: only noted voxels are read again."""
    grid, kept = VoxelGrid(0.1, 100), MapCloud(SETTINGS)
    grid.insert(site(np.random.default_rng(0)))
    before = kept.cloud(grid, CYLINDER).points
    grid.insert(site(np.random.default_rng(1)))
    grid.take_changes()
    np.testing.assert_array_equal(kept.cloud(grid, CYLINDER).points, before)


def test_clouds_that_were_given_out_do_not_change() -> None:
    grid, kept = VoxelGrid(0.1, 100), MapCloud(SETTINGS)
    grid.insert(site(np.random.default_rng(0)))
    first = kept.cloud(grid, CYLINDER).points
    copy = first.copy()
    grid.insert(site(np.random.default_rng(1)))
    assert len(kept.cloud(grid, CYLINDER)) > len(copy)
    np.testing.assert_array_equal(first, copy)


def test_another_grid_is_read_from_the_start() -> None:
    one, other, kept = VoxelGrid(0.1, 100), VoxelGrid(0.1, 100), MapCloud(SETTINGS)
    one.insert(site(np.random.default_rng(0)))
    other.insert(site(np.random.default_rng(1), 500))
    kept.cloud(one, CYLINDER)
    np.testing.assert_array_equal(
        kept.cloud(other, CYLINDER).points, MapCloud(SETTINGS).cloud(other.copy(), CYLINDER).points
    )


def test_an_empty_map_has_no_points() -> None:
    kept = MapCloud(SETTINGS)
    assert len(kept.cloud(VoxelGrid(0.1, 100), CYLINDER)) == 0
    assert kept.counts(kept.current(VoxelGrid(0.1, 100)), np.zeros(2), 3).sum() == 0


def test_upright_columns_are_counted_once_and_by_square_metres() -> None:
    grid, kept = VoxelGrid(1.0, 100), MapCloud(SETTINGS)
    grid.insert(np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 3.5], [-2.5, 7.5, 0.5], [5.5, 5.5, 0.5]] * 2))
    grid.insert(np.array([[4.5, 0.5, 0.5]]))  # one point is too few
    grid.erase(np.array([[5, 5, 0]]), 1)
    counts = kept.counts(kept.current(grid), np.array([0.0, 0.0]), 6)
    assert np.argwhere(counts).tolist() == [[6, 6]]
    assert counts[6, 6] == 1
    wide = kept.counts(kept.current(grid), np.array([0.25, 0.25]), 8)
    assert np.argwhere(wide).tolist() == [[5, 15], [8, 8]]
