"""The difference in form of two surfaces, independent of noise and density of their points.

The distance to the nearest point grows with the gaps between points, so that it cannot tell a
thinly sampled view of the right stone from a dense view of another. Heights above the surface do
not grow, and their means over a patch are nearly free of noise.
"""

import numpy as np
from executive_plugins.registration.similarity import Surface
from scipy.spatial import cKDTree

from executive.arrays import Float

_PATCH_M = 0.10  # radius of a patch: some twenty points 3 cm apart


def form_error(surface: Surface, points: Float, reach_m: float) -> float:
    """Return the root mean square over patches of a surface's mean height above another [m].

    Args:
        surface: The one surface, all around a stone.
        points: The other, of even density [m], shape (N, 3).
        reach_m: Points farther from the surface are left out [m].

    Returns:
        The error [m]; infinity if no point is within reach.
    """
    distances, rows = surface.nearest(points, reach_m)
    near = np.isfinite(distances)
    if not near.any():
        return float(np.inf)
    points, feet, normals = points[near], surface.points[rows[near]], surface.normals[rows[near]]
    outward = np.sign(np.einsum("ij,ij->i", normals, feet - surface.points.mean(axis=0)))
    heights = outward * np.einsum("ij,ij->i", points - feet, normals)
    patches = cKDTree(points).query_ball_point(points, _PATCH_M)
    means = np.array([heights[patch].mean() for patch in patches])
    return float(np.sqrt(np.mean(means**2)))
