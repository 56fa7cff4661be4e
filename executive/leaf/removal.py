"""Take a stone's place out of the map: the step of every leaf after which the stone may lie
otherwise.
"""

import numpy as np

from executive.arrays import Float
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.context import Context
from executive.messages.stone import Stone

_MARGIN_M = 0.1  # beyond a stone's farthest point: a hand's breadth


def reach_of(stone: Stone) -> float:
    """Return the distance [m] of a stone's farthest point from its centroid, and a hand's breadth
    more.
    """
    return float(np.linalg.norm(stone.points_map - stone.centroid_map, axis=1).max()) + _MARGIN_M


def remove_from_map(context: Context, stone: Stone, least_radius_m: float) -> tuple[int, int]:
    """Let the map forget a sphere about a stone (Mascaro 2020, Sec. 4.5).

    Deviation from the paper: the sphere takes in the whole stone. What a long one left outside
    R_obj was segmented as
    another stone later. Beyond the paper: what the sphere takes from stones beside this one is put
    back from the database, for no scan may come before the next plan.

    Args:
        context: The leaf's view of the mission; it needs mapping and objects.
        stone: Whose place.
        least_radius_m: R_obj [m].

    Returns:
        Number of points removed, and of those put back.
    """
    mapping, radius_m = context.use(Mapper), max(least_radius_m, reach_of(stone))
    removed = mapping.remove_sphere(stone.centroid_map, radius_m)
    put_back = 0
    for other in context.use(ObjectDatabase).stones():
        if other.id != stone.id and other.state.is_lying:
            cut = _within(other.points_map, stone.centroid_map, radius_m)
            mapping.add_surface(cut)
            put_back += len(cut)
    return removed, put_back


def _within(points: Float, centre: Float, radius_m: float) -> Float:
    return np.asarray(points[np.linalg.norm(points - centre, axis=1) <= radius_m])
