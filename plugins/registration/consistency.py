"""Groups of matches that agree on one rigid motion (Mascaro 2020, Sec. 4.4 step 4).

Two correct matches have the same distance from each other in both clouds.
"""

import numpy as np
from scipy.spatial.distance import cdist

from executive.arrays import Bool, Float
from executive.geometry.rigid_fit import rigid_fit

_SEEDS = 60  # matches that groups are grown from, those that agree with most others
_LEAST_GROUP = 4  # matches of a group
_LEAST_LEVER_M = 0.25  # closer keypoints do not determine the rotation


def consistent_transforms(
    target: Float, source: Float, tolerance_m: float, scale_error: float, count: int
) -> Float:
    """Return the rigid motions that most matches agree on, the most matches first.

    Args:
        target: Matched keypoints in the target [m], shape (M, 3).
        source: Their partners in the source [m], shape (M, 3).
        tolerance_m: Allowed difference of distances [m].
        scale_error: Allowed difference of distances, as a share of them.
        count: Most motions to return, b.

    Returns:
        T_target_source, shape (at most count, 4, 4).
    """
    if len(target) < _LEAST_GROUP:
        return np.empty((0, 4, 4))
    agrees = _agreement(target, source, tolerance_m, scale_error)
    seeds = np.argsort(-agrees.sum(axis=1), kind="stable")[:_SEEDS]
    groups = sorted((_grow(agrees, int(seed)) for seed in seeds), key=len, reverse=True)
    found: list[Float] = []
    taken: set[int] = set()
    for group in groups:
        if len(found) == count or len(group) < _LEAST_GROUP:
            break
        if len(taken.intersection(group)) <= len(group) // 2:  # else the same motion again
            found.append(rigid_fit(target[group], source[group]))
            taken.update(group)
    return np.array(found).reshape(-1, 4, 4)


def _agreement(target: Float, source: Float, tolerance_m: float, scale_error: float) -> Bool:
    between_t, between_s = cdist(target, target), cdist(source, source)
    agrees = np.abs(between_t - between_s) < tolerance_m + scale_error * between_s
    return np.asarray(agrees & (np.minimum(between_t, between_s) > _LEAST_LEVER_M))


def _grow(agrees: Bool, seed: int) -> list[int]:
    """Return a group of matches that all agree with each other, grown greedily from a seed.

    Candidates agree with the seed; those that agree with most other candidates come first.
    """
    friends = np.flatnonzero(agrees[seed])
    order = friends[np.argsort(-agrees[np.ix_(friends, friends)].sum(axis=1), kind="stable")]
    group, open_to = [seed], agrees[seed].copy()
    for candidate in order:
        if open_to[candidate]:
            group.append(int(candidate))
            open_to &= agrees[candidate]
    return group
