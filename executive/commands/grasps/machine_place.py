"""Where a machine stands beside a stone of a cloud that tells nothing of any machine."""

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.machine.machine import Machine
from executive.messages.segment import Segment, Segmentation

_SHARE = 0.6  # of its reach: where an arm is neither stretched nor folded
_SIDES = 24
_UP = np.array([0.0, 0.0, 1.0])


def beside(stone: Segment, segmentation: Segmentation, machine: Machine) -> Float:
    """Return T_map_base of a machine that faces a stone from the side with the most room, level on
    the ground.
    """
    around = 2 * np.pi * np.arange(_SIDES) / _SIDES
    away = np.column_stack([np.cos(around), np.sin(around)])
    places = stone.centroid[:2] + _SHARE * machine.reach_m * away
    others = [one.points[:, :2] for one in segmentation.segments if one.id != stone.id]
    room = [
        min((np.linalg.norm(p - place, axis=1).min() for p in others), default=np.inf)
        for place in places
    ]
    side = int(np.argmax(np.round(room, 6)))
    x_m, y_m = places[side]
    return standing(x_m, y_m, float(around[side]) + np.pi, segmentation, machine)


def standing(
    x_m: float, y_m: float, yaw_rad: float, segmentation: Segmentation, machine: Machine
) -> Float:
    """Return T_map_base of a machine that stands level on the ground's plane at a place, shape (4,
    4).
    """
    *normal, offset = segmentation.ground_plane
    ground_m = (offset - normal[0] * x_m - normal[1] * y_m) / normal[2]
    return pose(
        about_axis(_UP, yaw_rad), np.array([x_m, y_m, ground_m + machine.stance.base_height_m])
    )
