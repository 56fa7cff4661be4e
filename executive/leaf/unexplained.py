"""The map around a stone's place, without what other known stones explain."""

import numpy as np
from scipy.spatial import cKDTree

from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.context import Context
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone

_EXPLAINED_M = 0.08  # a point this near another stone's model is of that stone
# so high above its lowest point a stone's model begins to explain: below, the ground begins
_GROUND_M = 0.10


def unexplained(context: Context, stone: Stone, radius_m: float) -> Cloud:
    """Return the map within a distance of a stone's believed centroid (horizontally), less its
    neighbours.

    Args:
        context: The leaf's view of the mission; it needs mapping and objects.
        stone: Whose surroundings.
        radius_m: How far around [m].
    """
    points = context.use(Mapper).cloud().points
    points = points[np.hypot(*(points[:, :2] - stone.centroid_map[:2]).T) < radius_m]
    for other in context.use(ObjectDatabase).stones():
        if len(points) and other.id != stone.id and other.state.is_lying:
            points = points[~_explained(points, other.points_map)]
    return Cloud("map", points)


def _explained(points: np.ndarray, model: np.ndarray) -> np.ndarray:
    distances, _ = cKDTree(model).query(points, distance_upper_bound=_EXPLAINED_M)
    return np.asarray(np.isfinite(distances) & (points[:, 2] > model[:, 2].min() + _GROUND_M))
