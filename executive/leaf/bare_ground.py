"""The ground below a structure, as an even grid, from the ground points of a segmented map."""

import numpy as np

from executive.arrays import Float
from executive.messages.height_grid import HeightGrid
from executive.messages.structure import Structure

_CELL_M = 0.25
_AROUND_M = 2.0  # of ground around the foot: stones that are tried in physics may roll off


def bare_ground(points: Float, structure: Structure) -> tuple[HeightGrid, float]:
    """Return the heights below a structure, and the share of its foot whose ground was seen.

    Cells without a point take the height of the nearest cell with one.

    Args:
        points: Points of the ground in the map [m], shape (N, 3).
        structure: What is to be built.
    """
    from scipy.spatial import cKDTree  # reading a mission imports no algorithm

    low, high = structure.bounds()
    corner = low - _AROUND_M
    shape = np.ceil((high + _AROUND_M - corner) / _CELL_M).astype(int) + 1
    cells = np.round((points[:, :2] - corner) / _CELL_M).astype(int)
    inside = ((cells >= 0) & (cells < shape)).all(axis=1)
    flat = np.ravel_multi_index(tuple(cells[inside].T), tuple(shape))
    counts = np.bincount(flat, minlength=int(shape.prod()))
    sums = np.bincount(flat, weights=points[inside, 2], minlength=int(shape.prod()))
    nodes = np.argwhere(np.ones(tuple(shape), dtype=bool))
    is_seen = counts > 0
    if not is_seen.any():
        return HeightGrid(corner, _CELL_M, np.zeros(tuple(shape))), 0.0
    heights = np.where(is_seen, sums / np.maximum(counts, 1), 0.0)
    nearest = cKDTree(nodes[is_seen]).query(nodes[~is_seen])[1] if not is_seen.all() else []
    heights[~is_seen] = heights[is_seen][nearest]
    is_foot = structure.depth_m(corner + nodes * _CELL_M, np.zeros(len(nodes))) >= 0
    share = float(is_seen[is_foot].mean()) if is_foot.any() else 0.0
    return HeightGrid(corner, _CELL_M, heights.reshape(tuple(shape))), share
