"""The models of the lying stones, beside the map that shows the same site."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from executive.arrays import Bool, Float
from executive.errors import DataError
from executive.geometry.polygon import contains, outline_of
from executive.geometry.voxels import voxel_means
from executive.messages.stone import Stone


def surroundings(
    points_map: Float,
    stones: Sequence[Stone],
    without: Stone | None,
    cell_m: float,
    ground_m: float,
) -> Float:
    """Return the map merged with the models of the lying stones, one point a cell, shape (M, 3).

    Args:
        points_map: The map [m], shape (N, 3).
        stones: All known stones.
        without: A stone whose model and map points are left out, such as the one that is held.
        cell_m: Edge of a cell [m].
        ground_m: Height above the lowest point of the left-out model below which map points are
            kept, because they may be of the ground [m].
    """
    if without is not None:
        points_map = points_map[~_is_in_box(points_map, without.points_map, cell_m, ground_m)]
    models = [
        stone.points_map
        for stone in stones
        if stone.state.is_lying and (without is None or stone.id != without.id)
    ]
    return voxel_means(np.concatenate([points_map, *models]), cell_m)


def unexplained(
    points_map: Float,
    neighbours: Sequence[Stone],
    distance_m: float,
    ground_m: float,
    own: Stone | None = None,
) -> Float:
    """Return the points of the map that do not lie on a neighbour's model, shape (M, 3).

    Args:
        points_map: The map [m], shape (N, 3).
        neighbours: Stones whose points are left out.
        distance_m: A point this near to a model is of that stone [m].
        ground_m: Height above the lowest point of a model below which points beside it are kept,
            because they may be of the ground [m]. There is none at the foot of a stone that rests
            on another one.
        own: The stone whose points are kept, on which a neighbour may rest.
    """
    bases = [*neighbours, *([] if own is None else [own])]
    for stone in neighbours:
        if len(points_map):
            rests = any(_rests_on(stone, base, ground_m) for base in bases if base is not stone)
            is_explained = _is_explained(points_map, stone.points_map, distance_m)
            is_above = points_map[:, 2] > stone.points_map[:, 2].min() + ground_m
            is_hidden = not rests and _is_hidden_ground(points_map, stone, ground_m)
            points_map = points_map[~(is_explained & (is_above | rests) | is_hidden)]
    return points_map


def surface_within(stones: Sequence[Stone], centre_map: Float, radius_m: float) -> Float:
    """Return the points of models that lie in a sphere [m], shape (M, 3)."""
    parts = [stone.points_map[_is_within(stone, centre_map, radius_m)] for stone in stones]
    return np.concatenate([np.empty((0, 3)), *parts])


def _is_within(stone: Stone, centre_map: Float, radius_m: float) -> Bool:
    return np.asarray(np.linalg.norm(stone.points_map - centre_map, axis=1) <= radius_m)


def _rests_on(stone: Stone, base: Stone, ground_m: float) -> bool:
    """Return whether a stone rests on another one, which is below it and reaches farther down."""
    foot_m = stone.points_map[:, 2].min()
    if base.points_map[:, 2].min() > foot_m - ground_m:
        return False
    below = base.points_map[base.points_map[:, 2] < foot_m + ground_m]
    try:
        outline = outline_of(stone.points_map)
    except DataError:  # a few points on one line: there is nothing that could rest
        return False
    return bool(contains(outline, below[:, :2]).any())


def _is_hidden_ground(points: Float, stone: Stone, ground_m: float) -> Bool:
    """Return which points are ground under a stone, seen before the stone stood there.

    With the stone left out nothing would hide it, and what rests on the stone would hang above it.
    """
    is_low = np.abs(points[:, 2] - stone.points_map[:, 2].min()) < ground_m
    try:
        outline = outline_of(stone.points_map)
    except DataError:  # a few points on one line hide nothing
        return np.zeros(len(points), dtype=bool)
    is_low[is_low] = contains(outline, points[is_low, :2])
    return np.asarray(is_low)


def _is_explained(points: Float, model: Float, distance_m: float) -> Bool:
    distances, _ = cKDTree(model).query(points, distance_upper_bound=distance_m)
    return np.asarray(np.isfinite(distances))


def _is_in_box(points: Float, model: Float, cell_m: float, ground_m: float) -> Bool:
    """Return which points lie in the box of a model, but for its lowest part."""
    low, high = model.min(axis=0) - cell_m, model.max(axis=0) + cell_m
    low[2] += ground_m + cell_m
    return np.asarray(((points >= low) & (points <= high)).all(axis=1))
