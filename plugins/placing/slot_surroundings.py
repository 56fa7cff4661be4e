"""The surroundings of a slot: clearance of the stone and of the opening jaws."""

import numpy as np
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.geometry.convex import depth_inside, half_spaces
from executive.geometry.pose import inverse, transform
from executive.geometry.voxels import first_in_cells
from executive.machine.gripper import Gripper

_OPENINGS = (1.0, 0.75, 0.5)  # checked openings, as shares of the widest angle
_IN_GROUND_M = 0.02  # a ground point deeper than this in the gripper is a collision
_LEVEL_M = 0.15  # points higher than this above the ground belong to neighbours
# Least distance of a neighbour from the stone and the jaws; its far side may not have been seen.
_APART_M = 0.10
_GROUND_BAND_M = 0.35  # ground under the stone is at most this far from the slot's height
_HIGHEST = 0.95  # quantile of the ground heights on which the stone comes to lie
_SPACING_M = 0.05  # point spacing that suffices for the check


class SlotSurroundings:
    """The cloud near a slot, split into ground and neighbours."""

    def __init__(
        self, gripper: Gripper, cloud: Float, position_map: Float, radius_m: float
    ) -> None:
        angles = [fraction * gripper.open_rad for fraction in _OPENINGS]
        hulls = [
            hull for angle in angles for parts in gripper.hulls(angle).values() for hull in parts
        ]
        self._faces = [half_spaces(hull) for hull in hulls]
        self._reach_m = max(float(np.linalg.norm(hull, axis=1).max()) for hull in hulls) + _APART_M
        distance = np.linalg.norm(cloud[:, :2] - position_map[:2], axis=1)
        near = cloud[distance < radius_m + self._reach_m]
        near = near[first_in_cells(near, _SPACING_M)]
        level = float(position_map[2])
        under = cloud[
            (distance < 0.8 * radius_m) & (np.abs(cloud[:, 2] - level) < _GROUND_BAND_M), 2
        ]
        self.ground_m = float(np.quantile(under, _HIGHEST)) if len(under) else level
        is_high = near[:, 2] > self.ground_m + _LEVEL_M
        self._ground, self._neighbours = near[~is_high], near[is_high]
        self._tree = cKDTree(self._neighbours) if is_high.any() else None

    def is_free(self, T_map_gripper: Float, stone_map: Float) -> bool:
        """Return whether stone and opening jaws clear the neighbours, and the jaws the ground."""
        if self._tree is not None and self._tree.query(stone_map)[0].min() < _APART_M:
            return False
        if self._depth_m(self._neighbours, T_map_gripper) > -_APART_M:
            return False
        return self._depth_m(self._ground, T_map_gripper) < _IN_GROUND_M

    def _depth_m(self, points: Float, T_map_gripper: Float) -> float:
        """Return the largest depth of a point in the gripper at any of the openings [m].

        It is negative if all points are outside.
        """
        local = transform(inverse(T_map_gripper), points)
        local = local[np.linalg.norm(local, axis=1) < self._reach_m]
        return max(float(depth_inside(faces, local).max(initial=-np.inf)) for faces in self._faces)
