"""Room for the jaws that let a stone go, beside those that stand: as in height maps, from above."""

from collections.abc import Sequence

import numpy as np
from executive_plugins.placing.dry_stone.rasters import WallTop

from executive.arrays import Bool, Float, Int
from executive.machine.jaw_clearance import ROOM_M


def has_room(wall: WallTop, nodes: Int, heights_m: Float, jaws: Sequence[Float], R: Float) -> Bool:
    """Return at which places the jaws of one grasp at least are 5 cm above all stones that stand.

    The ground is not in their way: they had room there where the stone lay.

    Args:
        wall: The top of the structure.
        nodes: Places of the stone's origin, from the wall's corner, shape (P, 2).
        heights_m: Heights of its origin there, shape (P,) [m].
        jaws: Points of the jaws around the stone, of each grasp, shape (N, 3) in its frame [m].
        R: Rotation of the stone, shape (3, 3).
    """
    is_free = np.zeros(len(nodes), dtype=np.bool_)
    for points in jaws:
        cells, under_m = _underside(points @ R.T, wall.cell_m)
        left = np.flatnonzero(~is_free)
        at = nodes[left, None] + cells
        is_over: Bool = np.all((at >= 0) & (at < wall.top.shape), axis=2)
        i, j = np.where(is_over[..., None], at, 0).transpose(2, 0, 1)
        meets = wall.top[i, j] > heights_m[left, None] + under_m - ROOM_M
        is_free[left] = ~(meets & is_over & (wall.owner[i, j] >= 0)).any(axis=1)
    return is_free


def _underside(points: Float, cell_m: float) -> tuple[Int, Float]:
    """Return the cells below points, shape (C, 2), and the lowest height in each, (C,) [m]."""
    at = np.rint(points[:, :2] / cell_m).astype(np.int64)
    cells, which = np.unique(at, axis=0, return_inverse=True)
    under_m = np.full(len(cells), np.inf)
    np.minimum.at(under_m, which.ravel(), points[:, 2])
    return cells, under_m
