"""Ground that is known, nearly flat and clear of segments."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.geometry.voxels import first_in_cells
from executive.messages.segment import Segmentation

_RADIUS_M = 0.7  # radius of the disc of ground under a stone
_THIN_M = 0.07
_CELL_M = 0.28
_KNOWN = 0.7  # least share of the cells that hold a point


@dataclass(frozen=True, slots=True)
class GroundNeeds:
    """Requirements on the ground of a slot.

    Attributes:
        clearance_m: Least distance to any segment [m].
        max_slope_rad: Largest slope [rad].
        max_roughness_m: Largest standard deviation of the heights from their plane [m].
    """

    clearance_m: float
    max_slope_rad: float
    max_roughness_m: float


class FreeGround:
    """The ground of a segmentation; returns the height of places that meet the requirements."""

    def __init__(self, segmentation: Segmentation, needs: GroundNeeds) -> None:
        self._needs = needs
        self._ground = _thinned(segmentation.ground.points)
        self._ground_tree = cKDTree(self._ground[:, :2])
        taken = [segment.points[:, :2] for segment in segmentation.segments]
        self._taken_tree = cKDTree(np.concatenate(taken)) if taken else None

    def height_m(self, xy: Float) -> float | None:
        """Return the ground height at a place (2,) [m].

        None if the place is occupied, or its ground is unknown, too steep or too rough.
        """
        if self._taken_tree is not None and self._taken_tree.query(xy)[0] < self._needs.clearance_m:
            return None
        points = self._ground[
            np.sort(np.array(self._ground_tree.query_ball_point(xy, _RADIUS_M), dtype=np.int64))
        ]
        if not _covers(points[:, :2] - xy):
            return None
        A = np.column_stack([points[:, :2] - xy, np.ones(len(points))])
        (slope_x, slope_y, height), *_ = np.linalg.lstsq(A, points[:, 2], rcond=None)
        roughness = float(np.std(points[:, 2] - A @ (slope_x, slope_y, height)))
        is_flat = np.arctan(np.hypot(slope_x, slope_y)) <= self._needs.max_slope_rad
        return float(height) if is_flat and roughness <= self._needs.max_roughness_m else None


def _thinned(points: Float) -> Float:
    """Return the first point of each cell, for a dense map tells no more about a slot."""
    return points[np.sort(first_in_cells(points[:, :2], _THIN_M))]


def _covers(offsets: Float) -> bool:
    """Return whether enough cells of the disc hold a point; else its ground was not seen."""
    cells = int(np.pi * (_RADIUS_M / _CELL_M) ** 2)
    return len(np.unique(np.floor(offsets / _CELL_M).astype(int), axis=0)) >= _KNOWN * cells
