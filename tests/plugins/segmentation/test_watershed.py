"""A summit is a stone of its own if it is high enough above the pass, and wide enough."""

import numpy as np
import pytest
from executive_plugins.segmentation.watershed import basins

CELL_M = 0.0625  # a power of two: no rounding puts a point into the next cell
X, Y = (a.ravel() for a in np.meshgrid(np.arange(40), np.arange(9), indexing="ij"))
PLACES = (np.column_stack([X, Y]) + 0.5) * CELL_M
BROAD = np.maximum(1.0 - 0.08 * np.hypot(X - 12, Y - 4), 0.1)
SPIKE = np.where((np.abs(X - 32) <= 1) & (np.abs(Y - 4) <= 1), 0.9, 0.0)  # nine cells
TOPS = np.maximum(BROAD, SPIKE)


@pytest.mark.parametrize(("least_cells", "expected"), [(1, 2), (9, 2), (10, 1), (50, 1)])
def test_a_summit_needs_some_cells_above_the_pass(least_cells: int, expected: int) -> None:
    found = basins(PLACES, TOPS, CELL_M, 0.3, least_cells)
    assert len(set(found.tolist())) == expected
    if expected == 2:
        assert len(set(found[SPIKE > 0].tolist())) == 1
        assert found[SPIKE > 0][0] != found[np.argmax(BROAD)]


@pytest.mark.parametrize(("least_drop", "expected"), [(0.85, 2), (0.92, 1)])
def test_the_pass_must_be_low_enough(least_drop: float, expected: int) -> None:
    """The pass is at 0.1 m: a drop of 0.8 m is 0.89 of the lower summit's 0.9 m."""
    assert len(set(basins(PLACES, TOPS, CELL_M, least_drop, 1).tolist())) == expected
