"""Which places take which stones, so that the machine may lift each one there."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.geometry.pose import inverse, transform
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import Machine
from executive.messages.segment import Segmentation
from executive.messages.stone import STONE_DENSITY_KG_M3

_BEYOND_RAD = 100.0  # what a place beyond the lift capacity costs: more than all swings together


@dataclass(frozen=True, slots=True, eq=False)
class Load:
    """What is to be carried to a place.

    Attributes:
        mass_kg: Its mass by its volume.
        position_map: Middle of its points [m], shape (3,).
    """

    mass_kg: float
    position_map: Float


def loads(segmentation: Segmentation) -> list[Load]:
    """Return the stones of a site, the heaviest first."""
    found = [
        Load(
            volume_and_centroid(one.points)[0] * STONE_DENSITY_KG_M3, np.asarray(one.points).mean(0)
        )
        for one in segmentation.segments
    ]
    return sorted(found, key=lambda load: -load.mass_kg)


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


def swings_rad(loads: Sequence[Load], places_map: Float, T_map_base: Float) -> Float:
    """Return how far the cabin swings between stones and places [rad], shape (S, N)."""
    T_base_map = inverse(T_map_base)
    places, stones = (
        transform(T_base_map, points)
        for points in (places_map, np.array([load.position_map for load in loads]).reshape(-1, 3))
    )
    between = np.subtract.outer(_azimuths(stones), _azimuths(places))
    return np.asarray(np.abs((between + np.pi) % (2 * np.pi) - np.pi))


def _azimuths(points: Float) -> Float:
    return np.asarray(np.arctan2(points[:, 1], points[:, 0]))


def assigned(
    rated: Float, masses: Sequence[float], swings: Float, count: int
) -> list[tuple[int, int | None]]:
    """Return up to `count` places, each with the stone that it is for; both as indices.

    As many stones as possible get a place where they may be lifted, and those that do not, one that
    lacks little. Of all ways to do so, the one with the least swing of the cabin in all is chosen.
    Further places, which are for any stone, follow in their order of preference.

    Args:
        rated: Capacity of the places in their order of preference [kg], shape (N,).
        masses: Masses of the S stones, the heaviest first [kg].
        swings: Swing of the cabin between each stone and each place [rad], shape (S, N).
        count: Number of places wanted.
    """
    wanted = np.array(masses[:count], dtype=np.float64)
    beyond_kg = np.maximum(wanted[:, None] - rated, 0.0)
    cost = np.where(beyond_kg > 0, _BEYOND_RAD * (1.0 + beyond_kg), swings[: len(wanted)])
    stones, places = linear_sum_assignment(cost)
    taken = dict(zip(places.tolist(), stones.tolist(), strict=True))
    rest = [(place, None) for place in range(len(rated)) if place not in taken]
    return [*taken.items(), *rest][:count]
