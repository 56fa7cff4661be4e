"""Keypoints with descriptors of their surroundings, and matches between those of two maps."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float


@dataclass(frozen=True, slots=True, eq=False)
class Features:
    """Keypoints [m], shape (K, 3), and the descriptor of each, shape (K, 33)."""

    points: Float
    descriptors: Float


def match(target: Features, source: Features, nearest: int) -> tuple[Float, Float]:
    """Return the coordinates of matched keypoints, target and source, each (M, 3).

    Each source keypoint is matched with its nearest descriptors in the target (Sec. 4.4 step 3),
    found by one matrix product.
    """
    count = min(nearest, len(target.points))
    if not count or not len(source.points):
        return np.empty((0, 3)), np.empty((0, 3))
    t, s = target.descriptors, source.descriptors
    squares = (t**2).sum(axis=1)[None, :] - 2 * s @ t.T
    best = np.argsort(squares, axis=1, kind="stable")[:, :count]
    return target.points[best.ravel()], np.repeat(source.points, count, axis=0)
