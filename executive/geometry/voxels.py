"""Point clouds thinned by a cubic grid."""

import numpy as np

from executive.arrays import Float, Int


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
    shifted = points if corner is None else points - corner
    cells = np.floor(shifted / size_m).astype(np.int64)
    cells -= cells.min(axis=0)
    spans = cells.max(axis=0) + 1
    keys = (cells[:, 0] * spans[1] + cells[:, 1]) * spans[2] + cells[:, 2]
    _, inverse, counts = np.unique(keys, return_inverse=True, return_counts=True)
    sums = np.stack([np.bincount(inverse, weights=points[:, i]) for i in range(3)], axis=1)
    return np.asarray(sums / counts[:, None])


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
