"""Clouds of even density, about their middle."""

import numpy as np
from numba import njit

from executive.arrays import Float, read_only
from executive.geometry.voxels import voxel_means


def thinned(points: Float, voxel_m: float) -> Float:
    """Return the mean of the points in each occupied voxel [m], shape (M, 3)."""
    return voxel_means(points, voxel_m)


def sampled(points: Float, most: int) -> Float:
    """Return every n-th point, so that at most so many are left, shape (M, 3)."""
    return points[:: -(-len(points) // most) or 1]


def mean_point(points: Float) -> Float:
    """Return the mean of points [m], shape (N, 3), N ≥ 1, → (3,); their sums run in one order."""
    return np.asarray(_mean(read_only(points)))


def less(points: Float, middle: Float) -> Float:
    """Return points relative to a middle [m], shape (N, 3)."""
    return np.asarray(_less(read_only(points), middle))


def compile_thinning() -> None:
    """Compile the inner loops."""
    less(np.zeros((1, 3)), mean_point(np.zeros((1, 3))))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _mean(points: Float) -> Float:
    x, y, z = 0.0, 0.0, 0.0
    for n in range(len(points)):
        x, y, z = x + points[n, 0], y + points[n, 1], z + points[n, 2]
    return np.array([x, y, z]) / len(points)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _less(points: Float, middle: Float) -> Float:
    found = np.empty_like(points)
    for n in range(len(points)):
        for a in range(3):
            found[n, a] = points[n, a] - middle[a]
    return found
