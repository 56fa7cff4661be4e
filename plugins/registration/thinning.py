"""Clouds of even density."""

import numpy as np
import small_gicp

from executive.arrays import Float


def thinned(points: Float, voxel_m: float) -> Float:
    """Return the mean of the points in each occupied voxel [m], shape (M, 3); one thread."""
    return np.array(small_gicp.voxelgrid_sampling(points, voxel_m, 1).points()[:, :3])


def sampled(points: Float, most: int) -> Float:
    """Return every n-th point, so that at most so many are left, shape (M, 3)."""
    return points[:: -(-len(points) // most) or 1]
