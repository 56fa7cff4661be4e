"""The height of an object above what is below it."""

import numpy as np

from executive.arrays import Float

_MARGINS_M = (0.0, 0.5, 1.0, 1.5)  # distances around the object in which ground is looked for


def gap_below(surface: Float, points: Float) -> float:
    """Return the height of an object's lowest point above the highest point under it [m].

    Negative if the object reaches below that point. Where no point is under the object, because
    the map has forgotten the place that it was taken from, the median height of the points beside
    it is taken for the ground. If there is none within 1.5 m either, the gap is 0.

    Args:
        surface: The object's surface [m], shape (N, 3), z upwards.
        points: The surroundings without the object, in the same frame [m], shape (M, 3).
    """
    low, high = surface.min(axis=0), surface.max(axis=0)
    lower = points[points[:, 2] < high[2]]
    for margin_m in _MARGINS_M:
        is_under = (lower[:, :2] >= low[:2] - margin_m) & (lower[:, :2] <= high[:2] + margin_m)
        under = lower[is_under.all(axis=1), 2]
        if len(under):
            return float(low[2] - (under.max() if margin_m == 0.0 else np.median(under)))
    return 0.0
