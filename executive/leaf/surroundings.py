"""The map and the known stones as planners need them, gathered beside the tick."""

from collections.abc import Generator

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, transform
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.context import Context
from executive.leaf.job import Job
from executive.messages.cloud import Cloud
from executive.messages.hold import Hold
from executive.messages.stone import StoneState


def map_cloud(context: Context) -> Generator[Job[Cloud], Cloud, Cloud]:
    """Return the map as it is now, which takes more than a share of a tick after a scan.

    Args:
        context: The leaf's view of the mission; it needs mapping.
    """
    return (yield from context.job(context.use(Mapper).cloud))


def surroundings(
    context: Context, without: int | None = None
) -> Generator[Job[Cloud], Cloud, Cloud]:
    """Return the map merged with the object models (Mascaro et al. 2020, Sec. 5.2).

    Args:
        context: The leaf's view of the mission; it needs mapping and objects.
        without: Id of a stone whose model and map points are left out, such as the held one.
    """
    cloud = yield from map_cloud(context)
    return (yield from context.job(context.use(ObjectDatabase).surroundings, cloud, without))


def unexplained(
    context: Context, stone_id: int, radius_m: float
) -> Generator[Job[Cloud], Cloud, Cloud]:
    """Return the map around a stone's estimated place, without points of other known stones.

    Args:
        context: The leaf's view of the mission; it needs mapping and objects.
        stone_id: Id of the stone.
        radius_m: Horizontal distance from the stone's centroid [m].
    """
    cloud = yield from map_cloud(context)
    objects = context.use(ObjectDatabase)
    return (yield from context.job(objects.unexplained, cloud, stone_id, radius_m))


def held_surface(context: Context, hold: Hold) -> Float:
    """Return the held stone's surface in the gripper's frame [m], shape (N, 3)."""
    stone = context.use(ObjectDatabase).stone(hold.stone_id)
    return np.asarray(transform(inverse(hold.T_map_gripper), stone.points_map))


def held_stone(context: Context) -> int | None:
    """Return the id of the stone that is held as the database has it; None if none is."""
    stones = context.use(ObjectDatabase).stones()
    return next((stone.id for stone in stones if stone.state is StoneState.HELD), None)


def held_kg(context: Context) -> float | None:
    """Return the most that the held stone weighs by 95 % [kg]; None while nobody has weighed it.

    Until the monitors have weighed it on its way, it weighs what its trial lift told.
    """
    weight = context.weight() or context.trial_weight()
    return None if weight is None else weight.mass_kg + 2 * weight.std_kg
