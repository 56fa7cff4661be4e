"""Which segments of two clouds are the same stone under a motion (Mascaro 2020,
Sec. 4.4 step 4).
"""

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from executive.arrays import Float


def matched_centroids(
    target: Float, moved: Float, max_distance_m: float
) -> tuple[tuple[int, int], ...]:
    """Pair each moved source centroid with at most one target centroid, nearest in sum.

    Deviation from the paper's nearest neighbour: one to one, so that two stones do not vote for the
    same partner.

    Args:
        target: Target centroids [m], shape (N, 3).
        moved: Source centroids in the target's frame [m], shape (M, 3).
        max_distance_m: Largest distance of a pair, d_match [m].

    Returns:
        Pairs (source, target) of row numbers, in order of the source.
    """
    if not len(target) or not len(moved):
        return ()
    distances = cdist(moved, target)
    costs = np.minimum(distances, max_distance_m)
    rows, columns = linear_sum_assignment(costs)
    return tuple(
        (int(i), int(j))
        for i, j in zip(rows, columns, strict=True)
        if distances[i, j] < max_distance_m
    )
