"""The feet of objects: points that are too low to be told from the ground by height alone."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from executive.arrays import Float


def feet_of(parts: Sequence[Float], low: Float, reach_m: float) -> list[Float]:
    """Return the foot of each object.

    Args:
        parts: Points of each object above its foot [m], shapes (N, 3).
        low: Points a little above the ground [m], shape (L, 3).
        reach_m: Largest distance of a foot's point from the points of its object [m].

    Returns:
        For each object the points of `low` that are within reach of it, and nearer to it than to
        any other [m], shapes (F, 3).
    """
    none = np.zeros((0, 3))
    if not len(low) or not reach_m:
        return [none] * len(parts)
    highest_m = low[:, 2].max() + reach_m
    near = [part[part[:, 2] <= highest_m] for part in parts]
    if not any(len(part) for part in near):
        return [none] * len(parts)
    owner = np.repeat(np.arange(len(near)), [len(part) for part in near])
    tree = cKDTree(np.concatenate(near))
    distance_m, nearest = tree.query(low, distance_upper_bound=reach_m)
    found = np.isfinite(distance_m)
    of = owner[nearest[found]]
    return [low[found][of == k] for k in range(len(parts))]
