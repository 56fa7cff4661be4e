"""Candidate motions from the arrangement of the segments' centroids, without descriptors.

Deviation from Mascaro 2020, Sec. 4.4 step 4, where motions come from descriptors alone: FPFH
descriptors of a partly seen stone match in one case of ten. Here, each two pairs of centroids of
the same distance give a planar motion that also aligns the ground planes. These motions are ranked
and tested like those from descriptors.
"""

from itertools import combinations

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.geometry.rigid_fit import rigid_fit

_LEAST_PAIR_M = 0.8  # closer centroids do not determine the heading well
_DUPLICATE_M = 0.3  # motions are the same if no centroid differs by more


def constellation_transforms(
    target: tuple[Float, Float],
    source: tuple[Float, Float],
    tolerance_m: float,
    vote_m: float,
    count: int,
) -> Float:
    """Return motions that align pairs of centroids, those that most centroids support first.

    Args:
        target: Segment centroids (N, 3) and ground plane (4,) of the target.
        source: The same of the source.
        tolerance_m: Allowed difference of a pair's distances [m]; the centroid of a stone seen from
            one side is off by up to 0.3 m.
        vote_m: Distance up to which a third centroid supports a motion [m].
        count: Most motions to return.

    Returns:
        T_target_source, shape (at most count, 4, 4).
    """
    T_level_t, T_level_s = _level(target[1]), _level(source[1])
    t, s = (
        centroids @ T[:3, :3].T + T[:3, 3]
        for (centroids, _), T in ((target, T_level_t), (source, T_level_s))
    )
    headings = _hypotheses(t[:, :2], s[:, :2], tolerance_m)
    if not len(headings):
        return np.empty((0, 4, 4))
    moved = np.einsum("hij,nj->hni", headings[:, :, :2], s[:, :2]) + headings[:, None, :, 2]
    distances = np.linalg.norm(moved[:, :, None] - t[None, None, :, :2], axis=3)
    support = np.maximum(vote_m - distances.min(axis=2), 0.0).sum(axis=1)
    chosen: list[int] = []
    for h in np.argsort(-support, kind="stable"):
        if all(np.abs(moved[h] - moved[c]).max() > _DUPLICATE_M for c in chosen):
            chosen.append(int(h))
        if len(chosen) == count:
            break
    return np.array(
        [inverse(T_level_t) @ _planar(headings[h], t, s, vote_m) @ T_level_s for h in chosen]
    )


def _level(plane: Float) -> Float:
    """Return T_level_cloud: z along the ground's normal, zero on the ground."""
    x = np.cross([0.0, 1.0, 0.0], plane[:3])
    x /= np.linalg.norm(x)
    return pose(np.vstack([x, np.cross(plane[:3], x), plane[:3]]), np.array([0.0, 0.0, -plane[3]]))


def _hypotheses(t: Float, s: Float, tolerance_m: float) -> Float:
    """Return the planar motions (R | t) of all two pairs of similar distance, shape (H, 2, 3)."""
    found = []
    for i, j in combinations(range(len(s)), 2):
        d_s = s[j] - s[i]
        length = np.linalg.norm(d_s)
        for k, m in combinations(range(len(t)), 2):
            d_t = t[m] - t[k]
            if length < _LEAST_PAIR_M or abs(np.linalg.norm(d_t) - length) > tolerance_m:
                continue
            for sign in (1.0, -1.0):
                yaw = np.arctan2(*(sign * d_t)[::-1]) - np.arctan2(*d_s[::-1])
                R = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
                shift = 0.5 * (t[k] + t[m]) - R @ (0.5 * (s[i] + s[j]))
                found.append(np.column_stack([R, shift]))
    return np.array(found)


def _planar(heading: Float, t: Float, s: Float, vote_m: float) -> Float:
    """Return a planar motion refitted to all centroids that support it, shape (4, 4).

    It is the pose between the frames that `_level` makes.
    """
    moved = s[:, :2] @ heading[:, :2].T + heading[:, 2]
    distances = np.linalg.norm(moved[:, None] - t[None, :, :2], axis=2)
    nearest = distances.argmin(axis=1)
    close = distances.min(axis=1) < vote_m
    flat = np.array([1.0, 1.0, 0.0])
    if close.sum() >= 2:
        return rigid_fit(
            np.vstack([t[nearest[close]] * flat, _UP + t[nearest[close]] * flat]),
            np.vstack([s[close] * flat, _UP + s[close] * flat]),
        )
    T = np.eye(4)
    T[:2, :2], T[:2, 3] = heading[:, :2], heading[:, 2]
    return T


_UP = np.array([0.0, 0.0, 1.0])  # offset of a second layer of points, which keeps the refit upright
