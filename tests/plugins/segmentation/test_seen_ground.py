"""The share of a part below which ground is seen, on grids that are counted by hand."""

import numpy as np
import pytest
from executive_plugins.segmentation.seen_ground import SeenGround

from executive.arrays import Float

CELL_M = 0.125  # exact in binary, as all places are
INDICES = np.stack(np.meshgrid(np.arange(10), np.arange(10)), axis=-1).reshape(-1, 2)
PART = 5.0 + INDICES * CELL_M  # a hundred cells, with a point in the lowest corner of each
MIDDLES = PART + 0.5 * CELL_M


@pytest.mark.parametrize("rows", [0, 3, 10])
def test_ground_counts_by_the_cells_of_the_part(rows: int) -> None:
    near = MIDDLES[INDICES[:, 0] < rows]
    far = np.vstack([near, near, PART - 3.0, PART + 3.0])
    assert SeenGround(lambda: far, CELL_M).share_below(PART) == pytest.approx(rows / 10)


def test_cells_without_a_point_of_the_part_do_not_count() -> None:
    rim = ((INDICES == 0) | (INDICES == 9)).any(axis=1)
    ground = SeenGround(lambda: MIDDLES[~rim], CELL_M)
    assert ground.share_below(PART[rim]) == 0.0
    assert ground.share_below(PART) == pytest.approx(0.64)


def test_the_ground_is_looked_for_once_and_only_if_it_is_asked_for() -> None:
    calls = []

    def find() -> Float:
        calls.append(1)
        return PART

    ground = SeenGround(find, CELL_M)
    assert not calls
    assert ground.share_below(PART) == ground.share_below(PART) == 1.0
    assert calls == [1]
