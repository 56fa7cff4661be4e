"""Sizes follow from the machine and from the cloud."""

import numpy as np
import pytest
from executive_plugins.segmentation.limits import limits_for
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from executive_plugins.segmentation.spacing import spacing_m
from executive_plugins.segmentation.stone_sizes import stone_sizes

from executive.machine.machine import load_machine

MACHINE = load_machine("m545")
SIZES = stone_sizes(MACHINE)


def test_a_machine_that_lifts_eight_times_as_much_takes_stones_twice_as_long() -> None:
    stance = MACHINE.stance.model_copy(update={"payload_kg": 8 * MACHINE.payload_kg})
    strong = stone_sizes(MACHINE.model_copy(update={"stance": stance}))
    assert strong.most_m == pytest.approx(2 * SIZES.most_m)
    assert strong.least_m == SIZES.least_m
    assert SIZES.width_m == MACHINE.gripper.max_opening_m


def test_settings_come_before_the_machine() -> None:
    settings = GroundAndClustersSettings(min_extent_m=0.5, max_extent_m=1.0, min_height_m=0.3)
    limits = limits_for(settings, SIZES)
    assert (limits.least_extent_m, limits.most_extent_m, limits.least_height_m) == (0.5, 1.0, 0.3)


def test_grids_grow_with_the_spacing_and_never_shrink_below_what_is_set() -> None:
    settings = GroundAndClustersSettings()
    near, far = limits_for(settings, SIZES, 0.01), limits_for(settings, SIZES, 0.14)
    assert near == limits_for(settings, SIZES)
    for grid in ("voxel_m", "fine_voxel_m", "cell_m", "patch_m"):
        assert getattr(near, grid) == getattr(settings, grid)
        assert getattr(far, grid) == pytest.approx(2 * getattr(near, grid))
    for size in ("least_height_m", "most_extent_m", "most_width_m", "heap_m"):
        assert getattr(far, size) == getattr(near, size)
    assert far.least_points == near.least_points // 4
    assert far.least_extent_m == pytest.approx(4 * 0.14)


def test_the_spacing_of_a_grid_is_its_edge() -> None:
    grid = np.mgrid[0:60, 0:60, 0:1].reshape(3, -1).T * 0.05
    assert spacing_m(grid) == pytest.approx(0.05)
    assert spacing_m(grid[:4]) == 0.0


def test_points_in_the_air_do_not_make_a_surface_sparse() -> None:
    surface = np.mgrid[0:40, 0:40, 0:1].reshape(3, -1).T * 0.03
    rng = np.random.default_rng(4)
    air = rng.uniform(0, 20, (1900, 3)) + [0, 0, 1]
    mixed = rng.permutation(np.vstack([surface, air]))
    assert spacing_m(mixed) == pytest.approx(0.03, rel=0.01)
    assert spacing_m(air) > 0.5
