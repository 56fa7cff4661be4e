"""A body within a structure that is taken for a lost stone, wherever that has come to lie."""

import numpy as np

from executive.arrays import Bool, Float
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose
from executive.messages.building import StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.stone import Stone
from executive.messages.structure import Structure

_CELL_M = 0.1  # of the ground: neighbouring cells with something on them are of one body
_ABOVE_M = 0.15  # what is lower may be ground: three deviations of it, and of the map
_LEAST = 0.25  # share of the stone's outline: a view from one side, of a stone on a narrower side
_FLAT_M = 0.02  # standard deviation of the noise of a map: what is as flat has no volume


def body_within(
    points: Float, stone: Stone, structure: Structure, ground: HeightGrid
) -> StandingStone | None:
    """Return the largest body that may be a stone, as the convex hull of what is seen of it.

    Args:
        points: Points of the map around the stone's last place that are on no other stone, with
            the ground [m], shape (N, 3).
        stone: The stone that nobody has found.
        structure: Bodies that reach into its foot count.
        ground: The ground before the first stone was placed.

    Returns:
        The body; None if none covers a quarter of the stone's outline.
    """
    seen = points[points[:, 2] > ground.at(points[:, :2]) + _ABOVE_M]
    is_in = structure.depth_m(seen[:, :2], np.zeros(len(seen))) >= 0.0
    body = _largest(seen, is_in) if is_in.any() else seen[:0]
    if len(_cells(body)) < _LEAST * len(_cells(stone.points_map)):
        return None
    if not len(body) or np.linalg.eigvalsh(np.cov(body.T))[0] < _FLAT_M**2:
        return None
    centre = body.mean(axis=0)
    vertices, triangles = hull_mesh(body - centre)
    solid = SolidStone(str(stone.id), vertices, triangles, stone.mass_kg)
    return StandingStone(solid, pose(t=centre))


def _cells(points: Float) -> Float:
    """Return the cells of the ground below points, once each, shape (C, 2)."""
    return np.unique(np.floor(points[:, :2] / _CELL_M), axis=0)


def _largest(points: Float, is_in: Bool) -> Float:
    """Return the points of the body with most points that count: of cells next to one another."""
    from scipy.ndimage import label  # reading a mission imports no algorithm

    cells = np.floor(points[:, :2] / _CELL_M).astype(np.int64)
    cells -= cells.min(axis=0)
    is_filled = np.zeros(cells.max(axis=0) + 1, dtype=bool)
    is_filled[tuple(cells.T)] = True
    bodies = label(is_filled, np.ones((3, 3)))[0][tuple(cells.T)]
    return np.asarray(points[bodies == np.bincount(bodies[is_in]).argmax()])
