"""The share of a part below which ground is seen, on grids that are counted by hand."""

import tracemalloc

import numpy as np
import pytest
from executive_plugins.segmentation.seen_ground import SeenGround

from executive.arrays import Float

CELL_M = 0.125  # exact in binary, as all places are
INDICES = np.stack(np.meshgrid(np.arange(10), np.arange(10)), axis=-1).reshape(-1, 2)
PART = 5.0 + INDICES * CELL_M  # a hundred cells, with a point in the lowest corner of each
MIDDLES = PART + 0.5 * CELL_M


def seen(places: Float) -> SeenGround:
    """Level ground at places (M, 2)."""
    points = np.column_stack([places, np.zeros(len(places))])
    return SeenGround(points, np.zeros(3), np.eye(3)[:, :2], CELL_M)


@pytest.mark.parametrize("rows", [0, 3, 10])
def test_ground_counts_by_the_cells_of_the_part(rows: int) -> None:
    near = MIDDLES[INDICES[:, 0] < rows]
    far = np.vstack([near, near, PART - 3.0, PART + 3.0])
    assert seen(far).share_below(PART) == pytest.approx(rows / 10)


def test_cells_without_a_point_of_the_part_do_not_count() -> None:
    rim = ((INDICES == 0) | (INDICES == 9)).any(axis=1)
    ground = seen(MIDDLES[~rim])
    assert ground.share_below(PART[rim]) == 0.0
    assert ground.share_below(PART) == pytest.approx(0.64)


def test_places_are_along_the_ground_and_about_its_centre() -> None:
    turned = np.array([[0.0, 0.6, 0.8], [1.0, 0.0, 0.0], [0.0, 0.8, -0.6]])  # rows: axes of ground
    centre = np.array([2.6e6, 1.2e6, 400.0])
    points = np.column_stack([MIDDLES[:50], np.full(50, 0.3)]) @ turned + centre
    ground = SeenGround(points, centre, turned[:2].T, CELL_M)
    assert ground.share_below(PART) == seen(MIDDLES[:50]).share_below(PART) == 0.5


def test_the_ground_is_not_copied() -> None:
    points = np.random.default_rng(0).uniform(0, 10, (200_000, 3))
    ground = SeenGround(points, np.zeros(3), np.eye(3)[:, :2], CELL_M)
    ground.share_below(PART)
    tracemalloc.start()
    try:
        ground.share_below(PART)
        assert tracemalloc.get_traced_memory()[1] < points.nbytes / 10
    finally:
        tracemalloc.stop()
