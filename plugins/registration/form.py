"""How far two surfaces differ in form, whatever the noise and the density of their points.

The distance to the nearest point grows with the gaps between points: thinly seen, the right stone
is as far off as another one densely seen. Heights above the surface do not, and their means over a
patch are nearly free of noise.
"""

import numpy as np
from executive_plugins.registration.similarity import Surface
from scipy.spatial import cKDTree

from executive.arrays import Float

_PATCH_M = 0.10  # radius: some twenty points at 3 cm


def form_error(surface: Surface, points: Float, reach_m: float) -> float:
    """Return the root mean square over patches of a surface's mean height above another [m].

    Args:
        surface: The one, about a stone's whole round.
        points: The other, thinned evenly [m], shape (N, 3); those beyond the reach are left out.
        reach_m: Farthest points that are the same surface [m].

    Returns:
        Infinity if no point is within reach.
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
