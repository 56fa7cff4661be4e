"""Which places take which stones, so that the machine may lift each one there."""

from collections.abc import Sequence

import numpy as np

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.geometry.pose import inverse, transform
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import Machine
from executive.messages.segment import Segmentation
from executive.messages.stone import STONE_DENSITY_KG_M3


def masses_kg(segmentation: Segmentation) -> list[float]:
    """Return the masses of the stones of a site by their volumes, the heaviest first [kg]."""
    volumes_m3 = (volume_and_centroid(one.points)[0] for one in segmentation.segments)
    return sorted((volume_m3 * STONE_DENSITY_KG_M3 for volume_m3 in volumes_m3), reverse=True)


def rated_kg(machine: Machine, places_map: Float, T_map_base: Float) -> Float:
    """Return the rated lift capacity at places on the ground, the gripper hanging [kg].

    Args:
        machine: The machine.
        places_map: The places [m], shape (N, 3).
        T_map_base: Pose of its chassis, shape (4, 4).

    Returns:
        Shape (N,); 0 where the gripper does not hang in reach.
    """
    capacity, places = LiftCapacity(machine), transform(inverse(T_map_base), places_map)
    found = [
        capacity.near(float(np.hypot(x, y)), float(np.arctan2(y, x))) for x, y in places[:, :2]
    ]
    return np.array([0.0 if one is None else one.rated_kg for one in found])


def assigned(rated: Float, masses: Sequence[float], count: int) -> list[int]:
    """Return the indices of up to `count` places, one for each stone and the others after them.

    Each stone takes the first place that is left where it may be lifted, or, if there is none, the
    one that is left where the most may be lifted.

    Args:
        rated: Capacity of the places in their order of preference [kg], shape (N,).
        masses: Masses of the stones, the heaviest first [kg].
        count: Number of places wanted.
    """
    left, taken = list(range(len(rated))), list[int]()
    wanted = [*masses, *([0.0] * max(count - len(masses), 0))]
    for mass_kg in wanted[: min(count, len(left))]:
        fitting = (place for place in left if rated[place] >= mass_kg)
        place = next(fitting, max(left, key=lambda one: rated[one]))
        left.remove(place)
        taken.append(place)
    return taken
