"""Which segment is which known stone."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment

from executive.arrays import Float
from executive.messages.segment import Segment
from executive.messages.stone import Stone

_FORBIDDEN = 1e6


def associate(
    segments: Sequence[Segment], stones: Sequence[Stone], max_distance_m: float, max_ratio: float
) -> list[int]:
    """Pair segments with stones, one to one, of least distance in sum.

    A pair needs its centroids near each other, and no side longer than the stone's longest by more than a ratio: two
    merged stones are not one that has grown.

    Returns:
        For each segment the row of its stone, or −1.
    """
    if not segments or not stones:
        return [-1] * len(segments)
    costs = np.full((len(segments), len(stones)), _FORBIDDEN)
    for i, segment in enumerate(segments):
        for j, stone in enumerate(stones):
            distance = _distance_m(segment, stone)
            if distance <= max_distance_m and _longest(segment.points) <= max_ratio * _longest(stone.points_map):
                costs[i, j] = distance
    partners = [-1] * len(segments)
    for i, j in zip(*linear_sum_assignment(costs), strict=True):
        if costs[i, j] < _FORBIDDEN:
            partners[i] = int(j)
    return partners


def _distance_m(segment: Segment, stone: Stone) -> float:
    """Return the distance of centroids; a stone seen from one side has its centroid off, so boxes count as well [m]."""
    centres = [0.5 * (p.min(axis=0) + p.max(axis=0)) for p in (segment.points, stone.points_map)]
    means = np.linalg.norm(segment.centroid - stone.centroid_map)
    return float(min(means, np.linalg.norm(centres[0] - centres[1])))


def _longest(points: Float) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0)))
