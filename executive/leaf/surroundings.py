"""The map and the known stones as planners need them, in one call of the plugins."""

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, transform
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.context import Context
from executive.messages.cloud import Cloud
from executive.messages.hold import Hold


def surroundings(context: Context, without: int | None = None) -> Cloud:
    """Return the map merged with the object models (Mascaro et al. 2020, Sec. 5.2).

    Args:
        context: The leaf's view of the mission; it needs mapping and objects.
        without: Id of a stone whose model and map points are left out, such as the held one.
    """
    return context.use(ObjectDatabase).surroundings(context.use(Mapper).cloud(), without)


def unexplained(context: Context, stone_id: int, radius_m: float) -> Cloud:
    """Return the map around a stone's estimated place, without points of other known stones.

    Args:
        context: The leaf's view of the mission; it needs mapping and objects.
        stone_id: Id of the stone.
        radius_m: Horizontal distance from the stone's centroid [m].
    """
    cloud = context.use(Mapper).cloud()
    return context.use(ObjectDatabase).unexplained(cloud, stone_id, radius_m)


def held_surface(context: Context, hold: Hold) -> Float:
    """Return the held stone's surface in the gripper's frame [m], shape (N, 3)."""
    stone = context.use(ObjectDatabase).stone(hold.stone_id)
    return np.asarray(transform(inverse(hold.T_map_gripper), stone.points_map))
