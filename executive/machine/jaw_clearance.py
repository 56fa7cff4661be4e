"""How far jaws have to open so that they come free of a stone, and how far neighbours let them."""

import numpy as np

from executive.arrays import Float
from executive.geometry.convex import depth_inside, half_spaces
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import inverse, transform
from executive.machine.gripper import Gripper

# By which jaws open at a place that has room for them. At the M545's tips it is 15 cm: half of it
# lets the stone go (`ReleaseStone`), the other half is 2.5 standard deviations of a release.
RELEASE_RAD = 0.12
# Room of opening jaws beside other stones: of the errors of their poses, and of the surfaces that
# were seen.
ROOM_M = 0.05
_APART_M = 0.05  # of points on the jaws: a cell of the height maps
_STEP_RAD = 0.02  # 4 cm at the tips of the M545's gripper
_OPENING_RAD = 0.05  # step at which opening jaws are compared: the room and half of it at the tips


def angle_free_of(
    gripper: Gripper, stone_gripper: Float, up_gripper: Float, least_rad: float, room_m: float
) -> float:
    """Return the least jaw angle at which the tips rise past a stone [rad].

    Jaws that have closed far hold a stone inside them, with their tips below its widest part. If
    they open by a little, it rises with them.

    Args:
        gripper: The gripper.
        stone_gripper: The stone's surface in the gripper's frame [m], shape (N, 3).
        up_gripper: The direction in which the gripper leaves, a unit vector in its own frame.
        least_rad: Angle from which on it is sought.
        room_m: Room between each tip and the stone [m].

    Returns:
        The angle; that of the widest opening if none is enough.
    """
    is_beside = np.abs(stone_gripper[:, 2]) <= gripper.jaw_width_m / 2 + room_m
    points = stone_gripper[is_beside]
    for angle_rad in np.arange(least_rad, gripper.open_rad, _STEP_RAD):
        left, right = gripper.tips(float(angle_rad))
        above_left = _sideways(points, left, up_gripper)
        above_right = _sideways(points, right, up_gripper)
        if not ((above_left > -room_m).any() or (above_right < room_m).any()):
            return float(angle_rad)
    return gripper.open_rad


def _sideways(points: Float, tip: Float, up: Float) -> Float:
    """Return how far those points that lie above a tip are from its way up, along y [m]."""
    away = points - tip
    height = away @ up
    return np.asarray((away[:, 1] - height * up[1])[height > 0.0])


def release_angles(gripper: Gripper, stone_gripper: Float, up_gripper: Float) -> Float:
    """Return the jaw angles between which a stone is let go, least first, shape (3,) [rad].

    The least one is that at which the tips just pass the stone on their way up: jaws that hold it
    are closed as far, or farther.

    Args:
        gripper: The gripper.
        stone_gripper: The stone's surface in the gripper's frame [m], shape (N, 3).
        up_gripper: The direction in which the gripper leaves, a unit vector in its own frame.
    """
    least_rad = angle_free_of(gripper, stone_gripper, up_gripper, 0.0, 0.0)
    return np.minimum(least_rad + RELEASE_RAD * np.array([0.0, 0.5, 1.0]), gripper.open_rad)


def angle_closed_on(gripper: Gripper, stone_gripper: Float) -> float:
    """Return the widest jaw angle at which a jaw touches a stone: that at which they hold it [rad].

    It is 0 where they meet without touching it. Of 17 holds of walls it was within 0.03 rad of the
    angle that was measured; jaws whose tips are below a stone's widest part are closed by 0.03 to
    0.46 rad more than the least angle of `release_angles`.

    Args:
        gripper: The gripper.
        stone_gripper: The stone's surface in the gripper's frame [m], shape (N, 3).
    """
    faces = {
        name: [half_spaces(shape.vertices) for shape in link.shapes]
        for name, link in gripper.links.items()
    }

    def touches(angle_rad: float) -> bool:
        for name, parts in faces.items():
            points = transform(inverse(gripper.T_gripper_jaw(name, angle_rad)), stone_gripper)
            if any((depth_inside(part, points) > 0.0).any() for part in parts):
                return True
        return False

    touching, free = 0.0, gripper.open_rad
    if touches(free):
        return free
    if not touches(touching):
        return touching
    while free - touching > _STEP_RAD:
        middle = (touching + free) / 2
        touching, free = (middle, free) if touches(middle) else (touching, middle)
    return free


def released_jaws(gripper: Gripper, stone_gripper: Float, up_gripper: Float) -> Float:
    """Return points on the palm, and on jaws that hold a stone and let it go, shape (N, 3) [m].

    They are in the gripper's frame, one in each cell of 5 cm that their surfaces pass. The
    arguments are those of `release_angles`.
    """
    from executive.geometry.voxels import first_in_cells  # slow to import: a mission needs none

    least_rad, _, widest_rad = release_angles(gripper, stone_gripper, up_gripper)
    angles = min(angle_closed_on(gripper, stone_gripper), least_rad), least_rad, widest_rad
    parts = [hull for angle in angles for hull in _jaws(gripper, float(angle))]
    parts += [shape.vertices for shape in gripper.palm_shapes]
    points = np.concatenate([_on_surface(hull) for hull in parts])
    return points[np.sort(first_in_cells(points, _APART_M))]


def _on_surface(corners: Float) -> Float:
    """Return points on the surface of a convex hull, at most `_APART_M` apart, shape (N, 3)."""
    vertices, triangles = hull_mesh(corners)
    found = []
    for a, b, c in vertices[triangles]:
        longest_m = max(np.linalg.norm(b - a), np.linalg.norm(c - b), np.linalg.norm(a - c))
        steps = int(np.ceil(longest_m / _APART_M)) + 1
        u, v = (one.ravel() / steps for one in np.mgrid[: steps + 1, : steps + 1])
        u, v = u[u + v <= 1.0 + 1e-9], v[u + v <= 1.0 + 1e-9]
        found.append(a + u[:, None] * (b - a) + v[:, None] * (c - a))
    return np.concatenate(found)


def angle_beside(
    gripper: Gripper, others_gripper: Float, least_rad: float, wanted_rad: float, room_m: float
) -> float:
    """Return the largest jaw angle up to a wanted one at which no jaw nears other stones [rad].

    Args:
        gripper: The gripper.
        others_gripper: Surfaces of other stones in the gripper's frame [m], shape (N, 3).
        least_rad: The angle that is returned if the jaws near them at all wider ones.
        wanted_rad: The angle up to which is sought.
        room_m: Room between the jaws and other stones [m].
    """
    for angle_rad in np.arange(wanted_rad, least_rad, -_STEP_RAD):
        if not _nears(gripper, others_gripper, float(angle_rad), room_m):
            return float(angle_rad)
    return least_rad


def can_open(
    gripper: Gripper, others_gripper: Float, from_rad: float, to_rad: float, room_m: float
) -> bool:
    """Return whether no jaw nears stones while it opens.

    Args:
        gripper: The gripper.
        others_gripper: Surfaces of the stones in the gripper's frame [m], shape (N, 3).
        from_rad: The angle now.
        to_rad: The angle up to which the jaws open.
        room_m: Room between the jaws and the stones [m].
    """
    angles_rad = np.append(np.arange(from_rad, to_rad, _OPENING_RAD), to_rad)
    return not any(_nears(gripper, others_gripper, float(one), room_m) for one in angles_rad)


def tips_sink_m(gripper: Gripper, up_gripper: Float, from_rad: float, to_rad: float) -> float:
    """Return by how much one of the tips comes down while the jaws move from an angle to another.

    Args:
        gripper: The gripper.
        up_gripper: The direction up, a unit vector in the gripper's frame.
        from_rad: The angle now.
        to_rad: The other angle.
    """
    angles_rad = np.linspace(from_rad, to_rad, 2 + int(abs(to_rad - from_rad) / _OPENING_RAD))
    heights_m = np.array([gripper.tips(float(one)) @ up_gripper for one in angles_rad])
    return float((heights_m[0] - heights_m.min(axis=0)).max())


def _nears(gripper: Gripper, points: Float, angle_rad: float, room_m: float) -> bool:
    """Return whether a point lies in one of the jaws, or nearer than that to its faces."""
    return bool(len(points)) and any(
        bool((depth_inside(half_spaces(corners), points) > -room_m).any())
        for corners in _jaws(gripper, angle_rad)
    )


def _jaws(gripper: Gripper, angle_rad: float) -> list[Float]:
    """Return the corners of all convex parts of both jaws."""
    parts = gripper.hulls(angle_rad)
    return [corners for name in gripper.links for corners in parts[name]]
