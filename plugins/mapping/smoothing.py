"""Smoothing of a voxel map: each voxel's mean moves to the weighted mean of its neighbourhood.

With a lidar's range noise of 2 cm, one surface covers two or three layers of 3 cm voxels, which
averaging within voxels does not merge. Averaged over 4.5 cm, the layers coincide, and thinning
leaves one. The cost: sharp edges are rounded by about a centimetre.
"""

import numpy as np
from numba import njit

from executive.arrays import Float, Int

BITS = 21  # a voxel's index along an axis; three of them fill 63 bits
_COLUMNS = np.array(
    [(i << (2 * BITS)) + (j << BITS) for i in (-1, 0, 1) for j in (-1, 0, 1)], dtype=np.int64
)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _smooth(keys: Int, means: Float, weights: Float, columns: Int, reach_m: float) -> Float:
    """Smooth in one pass over the sorted keys, with a pointer for each of nine voxel columns."""
    n = len(keys)
    starts = np.zeros(len(columns), dtype=np.int64)
    moved = np.empty_like(means)
    for i in range(n):
        x, y, z, total = 0.0, 0.0, 0.0, 0.0
        for c in range(len(columns)):
            lowest = keys[i] + columns[c] - 1  # the voxel below the neighbour of the same height
            at = starts[c]
            while at < n and keys[at] < lowest:
                at += 1
            starts[c] = at
            while at < n and keys[at] <= lowest + 2:
                dx, dy, dz = (
                    means[at, 0] - means[i, 0],
                    means[at, 1] - means[i, 1],
                    means[at, 2] - means[i, 2],
                )
                nearness = 1.0 - (dx * dx + dy * dy + dz * dz) / (reach_m * reach_m)
                if nearness > 0.0:
                    weight = weights[at] * nearness
                    x += weight * dx
                    y += weight * dy
                    z += weight * dz
                    total += weight
                at += 1
        moved[i, 0] = means[i, 0] + x / total
        moved[i, 1] = means[i, 1] + y / total
        moved[i, 2] = means[i, 2] + z / total
    return moved


def smoothed(keys: Int, means: Float, counts: Int, reach_m: float) -> Float:
    """Return each voxel's mean, moved towards its neighbours' means, weighted by their points.

    Args:
        keys: Increasing keys of the voxels, shape (N,).
        means: Mean point of each [m], shape (N, 3).
        counts: Number of points in each, at least 1, shape (N,).
        reach_m: Radius of the neighbourhood [m]; at most one voxel in each direction is used.
    """
    return np.asarray(_smooth(keys, means, counts.astype(np.float64), _COLUMNS, reach_m))
