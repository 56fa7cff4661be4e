"""How high ground may be: cones on the lowest heights, against all pairs of cells."""

import numpy as np
import pytest
from executive_plugins.segmentation.lower_cone import LowerCone

CELL_M, RISE, MARGIN_M = 0.5, 0.4, 0.05


def cells_of(shape: tuple[int, int]) -> np.ndarray:
    """Return the middles of the cells of a grid [m], row by row; the first sets its corner."""
    i, j = np.indices(shape)
    places = np.column_stack([i.ravel(), j.ravel()]) * CELL_M
    return np.asarray(places + np.where(places > 0, 0.25 * CELL_M, 0.0))


def cone_of(lowest: np.ndarray) -> np.ndarray:
    """Return the least of the medians over 3 × 3 cells and of their rises to a cell by steps."""
    around = np.pad(lowest, 1, mode="edge")
    n, m = lowest.shape
    nine = [around[a : a + n, b : b + m] for a in range(3) for b in range(3)]
    medians = np.median(nine, axis=0)
    i, j = (axis.ravel() for axis in np.indices(lowest.shape))
    along, across = np.abs(i[:, None] - i), np.abs(j[:, None] - j)
    ways = np.maximum(along, across) + (np.sqrt(2.0) - 1) * np.minimum(along, across)
    cone = (medians.ravel()[None] + RISE * CELL_M * ways).min(axis=1)
    return np.asarray(cone.reshape(lowest.shape))


@pytest.mark.parametrize("shape", [(1, 9), (9, 1), (2, 3), (6, 7), (12, 5)])
@pytest.mark.parametrize("seed", range(3))
def test_the_cone_is_the_least_rise_from_any_other_cell(shape: tuple[int, int], seed: int) -> None:
    lowest = np.random.default_rng(seed).uniform(0.0, 2.0, shape)
    above = (lowest - cone_of(lowest)).ravel()
    upright, upside_down = (
        LowerCone.under(cells_of(shape), heights, CELL_M, RISE)
        for heights in (lowest.ravel(), -lowest.ravel())
    )
    found = upright.may_be_ground(lowest.ravel(), MARGIN_M)
    np.testing.assert_array_equal(found, (above < MARGIN_M) & (above > -3 * MARGIN_M))
    assert upright.steep_share(MARGIN_M) == pytest.approx((above > MARGIN_M).mean())
    sunk = (-lowest - cone_of(-lowest)).ravel()
    assert upside_down.steep_share(MARGIN_M) == pytest.approx((sunk > MARGIN_M).mean())


def test_of_several_points_in_a_cell_the_lowest_counts() -> None:
    places, heights = cells_of((5, 5)), np.zeros(25)
    twice = np.vstack([places, places])
    both = np.append(heights + 0.3, heights)
    found = LowerCone.under(twice, both, CELL_M, RISE).may_be_ground(both, MARGIN_M)
    np.testing.assert_array_equal(found, np.arange(50) >= 25)


def test_cells_without_points_neither_lower_a_cone_nor_count_for_the_relief() -> None:
    """A step of 1 m, 3 m apart: the cells between them are empty, and ground could rise that."""
    places = cells_of((3, 12))
    column = np.arange(36) % 12
    is_seen = (column < 3) | (column > 8)
    heights = np.where(column > 8, 1.0, 0.0)
    places, heights = places[is_seen], heights[is_seen]
    wide, steep = (LowerCone.under(places, heights, CELL_M, rise) for rise in (0.4, 0.2))
    assert wide.may_be_ground(heights, MARGIN_M).all()  # 1.2 m over 6 cells
    np.testing.assert_array_equal(steep.may_be_ground(heights, MARGIN_M), heights < 0.5)  # 0.6 m
    assert steep.steep_share(MARGIN_M) == pytest.approx(0.5)


def test_a_single_reflection_below_the_ground_is_none_and_lowers_nothing() -> None:
    heights = np.zeros(49)
    heights[24] = -1.0
    found = LowerCone.under(cells_of((7, 7)), heights, CELL_M, RISE).may_be_ground(
        heights, MARGIN_M
    )
    np.testing.assert_array_equal(found, heights == 0.0)
