"""Point clouds thinned by a cubic grid."""

import numpy as np
from numba import njit

from executive.arrays import Float, Int
from executive.geometry.radix_sort import radix_order

_FARTHEST = 1 << 62  # beyond any cell's number


def voxel_means(points: Float, size_m: float, corner: Float | None = None) -> Float:
    """Return the mean of the points in each occupied cell of a cubic grid, shape (M, 3).

    The order is that of the cells (x, then y, then z). It does not depend on the order of the
    points, except for rounding in the sums.

    Args:
        points: Positions [m], shape (N, 3).
        size_m: Edge of a cell [m].
        corner: Where four edges of the grid meet [m], shape (3,); the origin if not given.
    """
    if not len(points):
        return points
    even = np.ascontiguousarray(points, dtype=np.float64)
    return np.asarray(_means(even, size_m, np.zeros(3) if corner is None else corner))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _means(points: Float, size_m: float, corner: Float) -> Float:  # pragma: no cover - compiled
    cells = np.empty((len(points), 3), dtype=np.int64)
    low, high = np.full(3, _FARTHEST), np.full(3, -_FARTHEST)
    for n in range(len(points)):
        for a in range(3):
            cells[n, a] = int(np.floor((points[n, a] - corner[a]) / size_m))
            low[a], high[a] = min(low[a], cells[n, a]), max(high[a], cells[n, a])
    spans = high - low + 1
    keys = np.empty(len(points), dtype=np.int64)
    for n in range(len(points)):
        x, y, z = cells[n] - low
        keys[n] = (x * spans[1] + y) * spans[2] + z
    means, counts = np.zeros((len(points), 3)), np.zeros(len(points), dtype=np.int64)
    found, last = -1, -1
    for n in radix_order(keys):
        if keys[n] != last:
            found, last = found + 1, keys[n]
        counts[found] += 1
        for a in range(3):
            means[found, a] += points[n, a]
    for m in range(found + 1):
        for a in range(3):
            means[m, a] /= counts[m]
    return means[: found + 1].copy()


def first_in_cells(coordinates: Float, size_m: float) -> Int:
    """Return the row of the first point in each occupied cell of a cubic grid, shape (M,).

    Args:
        coordinates: Positions [m], shape (N, d).
        size_m: Edge of a cell [m].

    Returns:
        Rows of `coordinates` in the order of the cells (x, then y, then z).
    """
    cells = np.floor(coordinates / size_m).astype(np.int64)
    _, first = np.unique(cells, axis=0, return_index=True)
    return np.asarray(first)
