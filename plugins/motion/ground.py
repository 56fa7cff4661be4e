"""The ground at a place: a plane through the lowest points around it."""

import numpy as np

from executive.arrays import Float

_RADIUS_M = 2.5
_CELL_M = 0.3
_LEAST_CELLS = 12
_STEEPEST_RAD = 0.6  # a steeper plane is not taken for ground
_UP = np.array([0.0, 0.0, 1.0])


def ground_normal(points: Float, place: Float) -> Float:
    """Return the upward unit normal of the ground around a place, shape (3,).

    It is vertical where there are too few points. A plane is fitted to the lowest point of each
    cell; cells above the plane (stones) are removed, three times.

    Args:
        points: Ground and objects on it, z up [m], shape (N, 3).
        place: Position, shape (3,).
    """
    x, y = points[:, 0] - place[0], points[:, 1] - place[1]
    low = _lowest(points[(np.abs(x) < _RADIUS_M) & (np.abs(y) < _RADIUS_M)])
    for _ in range(3):
        if len(low) < _LEAST_CELLS:
            return _UP
        plane = np.linalg.lstsq(
            np.c_[low[:, :2] - place[:2], np.ones(len(low))], low[:, 2], rcond=None
        )[0]
        above = low[:, 2] - np.c_[low[:, :2] - place[:2], np.ones(len(low))] @ plane
        low = low[above <= max(0.08, float(np.median(np.abs(above))))]
    normal = np.array([-plane[0], -plane[1], 1.0])
    normal /= np.linalg.norm(normal)
    return normal if normal[2] > np.cos(_STEEPEST_RAD) else _UP


def _lowest(points: Float) -> Float:
    if not len(points):
        return points
    cells = np.floor((points[:, :2] - points[:, :2].min(axis=0)) / _CELL_M).astype(np.int64)
    key = cells[:, 0] * (cells[:, 1].max() + 1) + cells[:, 1]
    order = np.lexsort((points[:, 2], key))
    _, first = np.unique(key[order], return_index=True)
    return np.asarray(points[order][first])
