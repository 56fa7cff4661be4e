"""Whether the map shows a body where a stone was last, though it is not recognised there."""

import numpy as np

from executive.arrays import Float, Int
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone

_CELL_M = 0.25  # of the ground under a stone: some cells a side, each with many points if seen
_HALF = 0.5


def is_filled(cloud: Cloud, stone: Stone) -> bool:
    """Return whether most of a stone's place is at least half as high as the stone.

    A stone that is gone leaves what it stood on, and one that was pushed by less than half of its
    width still fills most of its place. Of cells without points nothing is known: they count as not
    filled.

    Args:
        cloud: The map.
        stone: The stone, with its last known pose.
    """
    own = _tops(stone.points_map)
    low = float(stone.points_map[:, 2].min())
    centre = stone.centroid_map[:2]
    radius_m = float(np.linalg.norm(stone.points_map[:, :2] - centre, axis=1).max())
    seen = _tops(cloud.near(centre, radius_m + _CELL_M).points)
    filled = [cell in seen and seen[cell] - low >= _HALF * (top - low) for cell, top in own.items()]
    return sum(filled) > _HALF * len(own)


def _tops(points: Float) -> dict[tuple[int, int], float]:
    """Return the highest point of each cell of the ground [m]."""
    cells: Int = np.floor(points[:, :2] / _CELL_M).astype(np.int64)
    tops: dict[tuple[int, int], float] = {}
    for (x, y), z in zip(cells.tolist(), points[:, 2].tolist(), strict=True):
        tops[x, y] = max(z, tops.get((x, y), z))
    return tops
