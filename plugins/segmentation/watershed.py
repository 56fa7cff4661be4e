"""Watershed of the upper surface of a cluster: valleys between stones."""

import numpy as np
from executive_plugins.segmentation.union_find import root_of, set_labels
from numba import njit

from executive.arrays import Float, Int


@njit(cache=True)  # type: ignore[untyped-decorator]
def basins(
    places: Float, heights: Float, cell_m: float, least_drop: float, least_cells: int
) -> Int:
    """Part points by the watershed of their upper surface.

    Cells of a grid are flooded from the top. Where two summits meet at a pass, they stay two if the
    pass lies deep enough below the lower of them; else the lower one is a shoulder of the higher.

    Args:
        places: Positions along the ground [m], shape (N, 2).
        heights: Above the ground [m], shape (N,).
        cell_m: Grid edge [m]; a gap narrower than this is no valley.
        least_drop: From the lower summit to the pass, as a share of that summit's height.
        least_cells: Cells that a summit of its own has above the pass.

    Returns:
        Basin of each point, from 0 in order of the points, shape (N,).
    """
    cells, width, tops = _upper_surface(places, heights, cell_m)
    summit_of, areas = np.full(len(tops), -1), np.zeros(len(tops), dtype=np.int64)
    parents = np.arange(len(tops))
    for cell in np.argsort(-tops, kind="mergesort"):
        if tops[cell] == 0.0:
            break
        for step in (-width - 1, -width, -width + 1, -1, 1, width - 1, width, width + 1):
            if summit_of[cell + step] < 0:
                continue
            theirs = root_of(parents, summit_of[cell + step])
            if summit_of[cell] < 0:
                summit_of[cell] = theirs
            mine = root_of(parents, summit_of[cell])
            low, high = (mine, theirs) if tops[mine] < tops[theirs] else (theirs, mine)
            if low != high and (
                tops[low] - tops[cell] < least_drop * tops[low] or areas[low] < least_cells
            ):
                parents[low] = high
                areas[high] += areas[low]
        if summit_of[cell] < 0:
            summit_of[cell] = cell
        areas[root_of(parents, summit_of[cell])] += 1
    basin: Int = set_labels(parents, summit_of[cells])
    return basin


@njit(cache=True)  # type: ignore[untyped-decorator]
def _upper_surface(places: Float, heights: Float, cell_m: float) -> tuple[Int, int, Float]:
    """Return each point's cell, the cells in a row, and the height of the topmost point in each
    cell, 0 for none.

    The outermost cells are empty, so that all others have eight neighbours.
    """
    low_x, low_y = places[:, 0].min(), places[:, 1].min()
    rows = int((places[:, 0].max() - low_x) / cell_m) + 3
    width = int((places[:, 1].max() - low_y) / cell_m) + 3
    cells, tops = np.empty(len(places), dtype=np.int64), np.zeros(rows * width)
    for i in range(len(places)):
        cell = (
            (int((places[i, 0] - low_x) / cell_m) + 1) * width
            + int((places[i, 1] - low_y) / cell_m)
            + 1
        )
        cells[i] = cell
        tops[cell] = max(tops[cell], heights[i])
    return cells, width, tops
