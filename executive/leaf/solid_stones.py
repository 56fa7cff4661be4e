"""Solid stones of known ones: what building planners take, out of what was seen so far."""

from collections.abc import Sequence

import numpy as np

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.voxels import first_in_cells
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.sightings import is_underside_known
from executive.messages.building import StandingStone
from executive.messages.solid_stone import SolidStone
from executive.messages.stone import Stone, StoneState

_CELL_M = 0.04  # spacing of the points that the hull is made of: the noise of a map
_BAND_M = 0.15  # above the lowest seen part: what is taken for the foot's outline
_SUNK_M = 0.35  # a foot that seems to be farther below than this was never seen: it is not added
_TOUCH_M = 0.05  # above its lowest point: what touches the ground, or does once it settles by 3°
_CARRIED_M = 0.05  # around the centre: a stone of 0.4 m height let go 3 deviations (2° each) askew
_STEP_M = 0.05  # by which more of its lower side is taken to be what carries a stone
_WAYS = np.array([[np.cos(a), np.sin(a)] for a in np.arange(8) * np.pi / 4])
_ON_GROUND = (StoneState.ON_GROUND, StoneState.SET_ASIDE)


def solid_stone(
    stone: Stone, ground: Float, objects: ObjectDatabase, room_m: float = 0.0
) -> StandingStone:
    """Return the convex hull of a stone's known surface, and its pose, with the axes of the map.

    The foot of a stone that has not hung in the jaws above the lidars is not seen: segmentation
    ends a decimetre above the ground. The outline of the lowest seen part goes straight down to the
    ground on which the stone was found. So the hull is rather too large than too small, as is
    wanted of what is unknown. A stone that has slid or turned and lies on the ground again rests on
    a part that nobody has seen: what is lowest goes straight down, as far around as it takes to
    carry the stone as it lies.

    Args:
        stone: The stone, as the database has it now.
        ground: Points of the ground in the map, before anything was moved [m], shape (N, 3).
        objects: The database, which knows how the stone lay when it was found.
        room_m: By how much each side is taken to be farther out [m].

    Raises:
        DataError: If the known surface spans no volume.
    """
    T_then_now = _lay(stone, objects) @ inverse(stone.T_map_object)
    lying = transform(T_then_now, stone.points_map)
    lying = lying[np.sort(first_in_cells(lying, _CELL_M))]
    if not is_underside_known(objects, stone.id):
        lying = _with_foot(lying, ground)
    whole = transform(inverse(T_then_now), lying)
    if stone.state in _ON_GROUND:
        whole = _carried(whole, ground)
    _, centre = volume_and_centroid(whole)
    about = whole - centre
    if room_m > 0.0:
        away = np.linalg.norm(about[:, :2], axis=1, keepdims=True)
        about[:, :2] *= 1.0 + room_m / np.maximum(away, room_m)
    vertices, triangles = hull_mesh(about)
    solid = SolidStone(str(stone.id), vertices, triangles, stone.mass_kg, doubt_m=room_m)
    return StandingStone(solid, pose(t=centre))


def solid_stones(
    stones: Sequence[Stone], ground: Float, objects: ObjectDatabase, room_m: float = 0.0
) -> dict[int, StandingStone]:
    """Return the solid of each stone by its id, at its present pose."""
    return {one.id: solid_stone(one, ground, objects, room_m) for one in stones}


def _lay(stone: Stone, objects: ObjectDatabase) -> Float:
    """Return the pose at which the stone lay before it was first grasped, shape (4, 4)."""
    lay = stone.T_map_object
    history = objects.history(stone.id)
    if any(event.kind == "grasp" for event in history):
        for event in history:
            if event.kind == "grasp":
                break
            lay = event.T_map_object
    return lay


def _with_foot(points: Float, ground: Float) -> Float:
    """Return the points of a lying stone (N, 3), and the outline of its foot on the ground."""
    low = float(points[:, 2].min())
    foot_m = _ground_m(points, ground)
    if foot_m is None or not 0.0 < low - foot_m < _SUNK_M:
        return points
    foot = points[points[:, 2] < low + _BAND_M].copy()
    foot[:, 2] = foot_m
    return np.concatenate([points, foot])


def _carried(points: Float, ground: Float) -> Float:
    """Return the points of a stone on the ground (N, 3), and below them what carries it there."""
    low = float(points[:, 2].min())
    _, centre = volume_and_centroid(points)
    foot_m = _ground_m(points, ground)
    is_carried = _is_around(points[points[:, 2] < low + _TOUCH_M], centre)
    if is_carried or foot_m is None or low - foot_m >= _SUNK_M:
        return points
    above = points.copy()
    above[:, 2] = np.maximum(above[:, 2], foot_m)  # a foot that was added before is not below it
    for up_to_m in np.arange(foot_m + _STEP_M, above[:, 2].max() + _STEP_M, _STEP_M):
        foot = above[above[:, 2] < up_to_m].copy()
        if _is_around(foot, centre):
            break
    foot[:, 2] = foot_m
    return np.concatenate([above, foot])


def _is_around(foot: Float, centre: Float) -> bool:
    """Return whether points (N, 3) reach beyond a centre (3,) on all sides, from above."""
    if not len(foot):
        return False
    reach = ((foot[:, :2] - centre[:2]) @ _WAYS.T).max(axis=0)
    return bool(reach.min() >= _CARRIED_M)


def _ground_m(points: Float, ground: Float) -> float | None:
    """Return the height of the ground below a stone's points (N, 3) [m]; None if it is unknown."""
    middle = points[:, :2].mean(axis=0)
    radius = float(np.linalg.norm(points[:, :2] - middle, axis=1).max())
    below = ground[np.linalg.norm(ground[:, :2] - middle, axis=1) < radius + _BAND_M]
    return float(np.median(below[:, 2])) if len(below) else None
