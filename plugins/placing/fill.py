"""How much of a structure's envelope is stone, counted by cells of 4 cm."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Bool, Float, Int
from executive.messages.building import AsBuilt, StandingStone

_CELL_M = 0.04
# Columns stand beside the corners of round figures, so that no line passes through an edge.
_SHIFT = np.array([0.3819, 0.6180])
_AT_ONCE = 2_000_000  # pairs of columns and triangles


@dataclass(frozen=True, slots=True)
class Fill:
    """Shares of a volume that are stone, 0 to 1.

    Attributes:
        of_envelope: Of the whole envelope.
        below_top: Of the part of the envelope that lies below a stone or in it: the voids between
            the stones as they stand, whatever the height that is reached.
    """

    of_envelope: float
    below_top: float


def fill_of(built: AsBuilt) -> Fill:
    """Return the fill of a structure; where two stones overlap, their volume counts once."""
    structure = built.structure
    low, high = structure.bounds()
    counts = np.ceil((high - low) / _CELL_M).astype(int)
    columns = low + _CELL_M * (np.argwhere(np.ones(counts, dtype=bool)) + _SHIFT)
    ground = built.ground.at(columns)
    above = _CELL_M * (np.arange(int(np.ceil(structure.height_m / _CELL_M))) + 0.5)
    is_in = np.stack([structure.holds(columns, np.full(len(columns), h)) for h in above], axis=1)
    heights = ground[:, None] + above
    is_stone = np.zeros_like(is_in)
    for one in built.standing:
        is_stone |= _inside(one, columns, heights)
    is_covered = np.flip(np.logical_or.accumulate(np.flip(is_stone, axis=1), axis=1), axis=1)
    stone = float((is_stone & is_in).sum())
    return Fill(stone / is_in.sum(), stone / max(1, int((is_covered & is_in).sum())))


def _inside(one: StandingStone, columns: Float, heights: Float) -> Bool:
    """Return which places of columns (C, 2) at heights (C, H) are inside a stone, shape (C, H).

    By the winding number: faces above a place that look up, less those that look down.
    """
    corners = one.vertices_map()
    found = np.zeros(heights.shape, dtype=bool)
    low, high = corners[:, :2].min(axis=0), corners[:, :2].max(axis=0)
    near = np.flatnonzero(((columns >= low) & (columns <= high)).all(axis=1))
    faces = corners[one.stone.triangles]
    lot = max(1, _AT_ONCE // max(1, len(near)))
    winding = np.zeros((len(near), heights.shape[1]), dtype=np.int64)
    for first in range(0, len(faces), lot):
        column, z, sign = _crossings(faces[first : first + lot], columns[near])
        np.add.at(winding, column, sign[:, None] * (z[:, None] > heights[near][column]))
    found[near] = winding > 0
    return found


def _crossings(faces: Float, columns: Float) -> tuple[Int, Float, Int]:
    """Return where vertical lines meet faces (F, 3, 3): number of the column, height, direction."""
    a, b, c = faces[:, 0], faces[:, 1], faces[:, 2]
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    is_flat = np.abs(area) < 1e-12
    a, b, c, area = a[~is_flat], b[~is_flat], c[~is_flat], area[~is_flat]
    away = columns[:, None] - a[None, :, :2]
    along, across = (b - a)[None, :, :2], (c - a)[None, :, :2]
    u = (away[..., 0] * across[..., 1] - away[..., 1] * across[..., 0]) / area
    v = (along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0]) / area
    column, face = np.nonzero((u >= 0) & (v >= 0) & (u + v <= 1))
    rise = u[column, face] * (b - a)[face, 2] + v[column, face] * (c - a)[face, 2]
    return column, a[face, 2] + rise, np.sign(area[face]).astype(np.int64)
