"""The attitude in which a stone rests: that in which it lay before the jaws closed on it."""

from dataclasses import replace

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3
from executive.interfaces.objects import ObjectDatabase
from executive.messages.stone import Stone

_UP = np.array([0.0, 0.0, 1.0])
_GRASP = "grasp"  # of events, with the pose in which the stone lay
_OPPOSITE = 1e-9  # sine of an angle below which the axis of a rotation is not determined


def to_rest(stone: Stone, objects: ObjectDatabase) -> Float:
    """Return the motion that tilts a held stone back to its attitude at rest, shape (4, 4).

    The closing jaws tilt stones, by up to half a right angle. On the ground the stone stood on a
    side that carries it; set down as it hangs in the jaws, it would stand on an edge and fall over.
    The motion is the smallest rotation about the stone's centroid that brings the direction upward,
    in the stone's frame, back to what it was when the jaws closed. Ours, not the paper's, which
    takes the stone to be where it was in the jaws.

    Args:
        stone: The stone, as the database has it now.
        objects: The database, which knows how the stone lay when it was last grasped.
    """
    lay = [one.T_map_object for one in objects.history(stone.id) if one.kind == _GRASP]
    if not lay:
        return np.eye(4)
    up = stone.T_map_object[:3, :3] @ lay[-1][:3, :3].T @ _UP  # of the stone at rest, as it is now
    axis = np.cross(up, _UP)
    sine = float(np.linalg.norm(axis))
    if sine < _OPPOSITE:
        return np.eye(4)
    R = exp_so3(axis / sine * np.arctan2(sine, up @ _UP))
    return pose(R, stone.centroid_map - R @ stone.centroid_map)


def moved(stone: Stone, T_map_map: Float) -> Stone:
    """Return a stone after a motion in the map."""
    return replace(
        stone,
        points_map=transform(T_map_map, stone.points_map),
        centroid_map=transform(T_map_map, stone.centroid_map[None])[0],
        T_map_object=T_map_map @ stone.T_map_object,
    )
