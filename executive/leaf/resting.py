"""The attitude in which a stone rests: that in which it lay before the jaws closed on it."""

from dataclasses import replace

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import about_axis, exp_so3, log_so3
from executive.interfaces.objects import ObjectDatabase
from executive.messages.stone import Stone

_UP = np.array([0.0, 0.0, 1.0])
_GRASP = "grasp"  # of events, with the pose in which the stone lay
_SLIGHT = 0.01  # share of a tilt that tells which way a stone falls
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


def hung_over(stone: Stone, level: Float, T_map_object: Float, centre_map: Float) -> Float | None:
    """Return the pose of a stone as it hangs over the pose in which it is to rest, shape (4, 4).

    It is turned about the vertical alone. The point about which it has turned in the jaws is where
    it will be at rest, and the lowest point of the stone is no lower than it will be.

    Args:
        stone: The stone, as the database has it now.
        level: Motion that tilts it back, as `to_rest` returns it, shape (4, 4).
        T_map_object: Pose in which it is to rest, shape (4, 4).
        centre_map: The grasp centre of the gripper that holds it, in the map [m], shape (3,).

    Returns:
        The pose; None if the stone would fall over to the other side once it is let go: if its
        centre would first rise as it turns about its lowest point to its rest.
    """
    M = T_map_object[:3, :3] @ (level @ stone.T_map_object)[:3, :3].T
    turn = about_axis(_UP, float(np.arctan2(M[1, 0] - M[0, 1], M[0, 0] + M[1, 1])))
    in_stone = inverse(stone.T_map_object)
    centre = transform(in_stone, centre_map[None])[0]
    R = turn @ stone.T_map_object[:3, :3]
    points = transform(in_stone, stone.points_map)
    T = pose(R, transform(T_map_object, centre[None])[0] - R @ centre)
    hanging = transform(T, points)
    T[2, 3] += max(0.0, transform(T_map_object, points)[:, 2].min() - hanging[:, 2].min())
    back = turn @ exp_so3(_SLIGHT * log_so3(level[:3, :3])) @ turn.T
    arm = hanging.mean(axis=0) - hanging[np.argmin(hanging[:, 2])]
    return T if (back @ arm)[2] <= arm[2] else None


def moved(stone: Stone, T_map_map: Float) -> Stone:
    """Return a stone after a motion in the map."""
    return replace(
        stone,
        points_map=transform(T_map_map, stone.points_map),
        centroid_map=transform(T_map_map, stone.centroid_map[None])[0],
        T_map_object=T_map_map @ stone.T_map_object,
    )
