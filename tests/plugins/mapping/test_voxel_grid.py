"""Voxels with running means, against sums over all points."""

import numpy as np
import pytest
from executive_plugins.mapping.voxel_grid import VoxelGrid, _slot

from executive.errors import DataError


def expected(points: np.ndarray, voxel_m: float) -> tuple[np.ndarray, np.ndarray]:
    keys, inverse, counts = np.unique(
        np.floor(points / voxel_m), axis=0, return_inverse=True, return_counts=True
    )
    means = np.zeros_like(keys)
    np.add.at(means, inverse.ravel(), points)
    return means / counts[:, None], counts


def test_means_and_counts_are_those_of_all_points_in_a_voxel() -> None:
    points = np.random.default_rng(0).normal(0, 0.3, (20_000, 3))
    grid = VoxelGrid(0.1, memory=100_000)
    for part in np.array_split(points, 7):
        grid.insert(part)
    means, counts = grid.points()
    wanted, wanted_counts = expected(points, 0.1)
    np.testing.assert_allclose(means, wanted, atol=1e-12)
    np.testing.assert_array_equal(counts, wanted_counts)
    assert len(grid) == len(means)


def test_the_order_of_voxels_does_not_depend_on_the_order_of_points() -> None:
    rng = np.random.default_rng(0)
    points = rng.normal(0, 2, (5000, 3))
    a, b = VoxelGrid(0.1, 10**6), VoxelGrid(0.1, 10**6)
    a.insert(points)
    b.insert(points[rng.permutation(len(points))])
    np.testing.assert_allclose(a.points()[0], b.points()[0], atol=1e-12)


def test_it_grows_beyond_its_first_table() -> None:
    rng = np.random.default_rng(0)
    grid = VoxelGrid(0.03, 100)
    seen = [rng.uniform(-10, 10, (60_000, 3)) for _ in range(6)]
    for points in seen:
        grid.insert(points)
    assert len(grid) == len(expected(np.vstack(seen), 0.03)[0])


def test_removed_voxels_are_empty_until_new_points_fall_into_them() -> None:
    grid = VoxelGrid(0.1, 100)
    points = np.random.default_rng(0).uniform(-1, 1, (3000, 3))
    grid.insert(points)
    means, _ = grid.points()
    grid.keep(means[:, 0] < 0)
    assert grid.points()[0][:, 0].max() < 0
    grid.insert(points[:1] * [0, 1, 1] + [0.55, 0, 0])
    means, counts = grid.points()
    assert (means[:, 0] > 0).sum() == 1
    assert counts[means[:, 0] > 0] == [1]


def test_the_weight_of_old_points_decays() -> None:
    grid = VoxelGrid(1.0, memory=10)
    grid.insert(np.full((1000, 3), 0.2))
    grid.insert(np.full((60, 3), 0.8))
    np.testing.assert_allclose(grid.points()[0], 0.8, atol=0.01)


def test_noise_averages_out() -> None:
    rng = np.random.default_rng(0)
    grid = VoxelGrid(0.1, memory=1000)
    grid.insert(np.array([0.55, 0.55, 0.55]) + rng.normal(0, 0.012, (400, 3)))
    np.testing.assert_allclose(grid.points()[0][0], 0.55, atol=4 * 0.012 / np.sqrt(400))


def test_points_beyond_the_keys_are_refused() -> None:
    with pytest.raises(DataError, match="set the datum near the site"):
        VoxelGrid(0.03, 100).insert(np.array([[400_000.0, 0, 0]]))


def test_a_grid_has_room_at_once_for_what_is_expected_and_holds_the_same():
    points = np.argwhere(np.ones((60, 60, 60))) + 0.5  # more than a grid has room for at first
    ready, grown = VoxelGrid(1.0, 100, expected=len(points)), VoxelGrid(1.0, 100)
    rows = [len(grid.table().keys) for grid in (ready, grown)]
    for grid in (ready, grown):
        grid.insert(points)
    assert len(ready.table().keys) == rows[0]
    assert len(grown.table().keys) > rows[1]
    for one, other in zip(ready.points(), grown.points(), strict=True):
        assert np.array_equal(one, other)


def test_a_grid_keeps_its_room_when_voxels_are_removed_and_holds_what_is_kept():
    points = np.argwhere(np.ones((60, 60, 60))) + 0.5
    grid, other = VoxelGrid(1.0, 100, expected=len(points)), VoxelGrid(1.0, 100)
    rows = len(grid.table().keys)
    for one in (grid, other):
        one.insert(points)
        one.take_changes()
        one.keep(points[:, 0] < 20)
        assert one.take_changes() is None  # every row may hold another voxel
        one.insert(points[::2])
    assert len(grid.table().keys) == rows
    for found, wanted in zip(in_order(grid.rows()), in_order(other.rows()), strict=True):
        assert np.array_equal(found, wanted)


def test_a_grid_that_was_refilled_is_the_same_whatever_the_order_of_the_rows():
    rng = np.random.default_rng(26127101)
    grid, twin = VoxelGrid(0.1, 100), VoxelGrid(0.1, 100, expected=500_000)
    grid.insert(rng.uniform(-3, 3, (20_000, 3)))
    grid.erase(rng.integers(-30, 30, (40, 3)), 4)
    twin.refill(*(part[::-1] for part in grid.rows()))
    assert len(twin.table().keys) != len(grid.table().keys)
    for found, wanted in zip(twin.points(), grid.points(), strict=True):
        assert np.array_equal(found, wanted)


def in_order(rows):
    """Return rows in order of their voxels: a table has them in an order of its own."""
    order = np.argsort(rows[0])
    return [part[order] for part in rows]


def test_voxels_of_a_site_lie_near_the_rows_that_their_keys_give_them() -> None:
    """A hash that leaves out an axis sends all voxels of a row of the site to one row."""
    across = np.arange(-15, 15, 0.05) + 0.025
    x, y = (one.ravel() for one in np.meshgrid(across, across))
    points = np.column_stack([x, y, 0.3 * np.sin(x) * np.cos(y)])
    keys = np.full(1 << 21, -1, dtype=np.int64)
    indices = np.floor(points / 0.05).astype(np.int64) + (1 << 20)
    found = (indices[:, 0] << 42) | (indices[:, 1] << 21) | indices[:, 2]
    rows = np.array([_slot(keys, key) for key in found[::7]])  # of an empty table: their own
    assert len(np.unique(rows)) > 0.9 * len(rows)
