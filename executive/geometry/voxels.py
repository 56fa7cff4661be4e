"""Point clouds thinned by a cubic grid."""

import numpy as np
from numba import njit

from executive.arrays import Float, Int, read_only
from executive.geometry.radix_sort import radix_sorted


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
    even = read_only(np.asarray(points, dtype=np.float64))
    origin = read_only(np.zeros(3) if corner is None else corner)
    return np.asarray(_means(even, float(size_m), origin))


def compile_voxel_means() -> None:
    """Compile the inner loop of `voxel_means`, so that no cloud has to wait for it."""
    voxel_means(np.zeros((1, 3)), 1.0)


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _means(points: Float, size_m: float, corner: Float) -> Float:  # pragma: no cover - compiled
    keys, order = radix_sorted(_keys(points, size_m, corner))
    cells = 1  # counted first, so that the means take no more memory than their own
    for n in range(1, len(keys)):
        cells += keys[n] != keys[n - 1]
    means, found, n = np.empty((cells, 3)), 0, 0
    while n < len(keys):
        key, first = keys[n], n
        x, y, z = 0.0, 0.0, 0.0
        while n < len(keys) and keys[n] == key:
            row = order[n]
            x, y, z, n = x + points[row, 0], y + points[row, 1], z + points[row, 2], n + 1
        count = n - first
        means[found, 0], means[found, 1], means[found, 2] = x / count, y / count, z / count
        found += 1
    return means


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _keys(points: Float, size_m: float, corner: Float) -> Int:  # pragma: no cover - compiled
    """Number the cells of the points' bounding box, x, then y, then z; return each point's cell."""
    low, spans = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    for a in range(3):
        least, most = points[0, a], points[0, a]
        for n in range(len(points)):
            least, most = min(least, points[n, a]), max(most, points[n, a])
        low[a] = int(np.floor((least - corner[a]) / size_m))
        spans[a] = int(np.floor((most - corner[a]) / size_m)) - low[a] + 1
    keys = np.empty(len(points), dtype=np.int64)
    for n in range(len(points)):
        key = 0
        for a in range(3):
            cell = int(np.floor((points[n, a] - corner[a]) / size_m)) - low[a]
            key = key * spans[a] + cell
        keys[n] = key
    return keys


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
