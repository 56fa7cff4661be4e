"""Clouds of even density."""

from executive.arrays import Float
from executive.geometry.voxels import voxel_means


def thinned(points: Float, voxel_m: float) -> Float:
    """Return the mean of the points in each occupied voxel [m], shape (M, 3)."""
    return voxel_means(points, voxel_m)


def sampled(points: Float, most: int) -> Float:
    """Return every n-th point, so that at most so many are left, shape (M, 3)."""
    return points[:: -(-len(points) // most) or 1]
