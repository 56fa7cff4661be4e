"""The surroundings of a slot, and whether the stone and the opening jaws stay clear of them."""

import numpy as np
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.geometry.convex import depth_inside, half_spaces
from executive.geometry.pose import inverse, transform
from robot_models.gripper import Gripper

_OPENINGS = (1.0, 0.75, 0.5)  # of the widest: the jaws pass all of them
_DEEP_M = 0.02  # a point deeper than this in the gripper is a collision
_LEVEL_M = 0.15  # what is higher than this above the ground is a neighbour
_APART_M = 0.10  # between the stone and a neighbour
_GROUND_BAND_M = 0.35  # ground under the stone is within this of the slot's height
_HIGHEST = 0.95  # quantile of the heights under the stone that carry it


class SlotSurroundings:
    """The cloud near a slot."""

    def __init__(self, gripper: Gripper, cloud: Float, position_map: Float, radius_m: float) -> None:
        angles = [fraction * gripper.open_rad for fraction in _OPENINGS]
        self._faces = [half_spaces(hull) for a in angles for parts in gripper.hulls(a).values() for hull in parts]
        reach_m = radius_m + 2 * gripper.max_opening_m
        distance = np.linalg.norm(cloud[:, :2] - position_map[:2], axis=1)
        self._near = cloud[distance < reach_m]
        level = position_map[2]
        under = cloud[(distance < 0.8 * radius_m) & (np.abs(cloud[:, 2] - level) < _GROUND_BAND_M), 2]
        self.ground_m = float(np.quantile(under, _HIGHEST)) if len(under) else float(level)
        neighbours = self._near[self._near[:, 2] > self.ground_m + _LEVEL_M]
        self._neighbours = cKDTree(neighbours) if len(neighbours) else None

    def is_free(self, T_map_gripper: Float, stone_map: Float) -> bool:
        """Return whether the stone keeps off its neighbours, and the opening jaws off everything."""
        if self._neighbours is not None and self._neighbours.query(stone_map)[0].min() < _APART_M:
            return False
        local = transform(inverse(T_map_gripper), self._near)
        return all(float(depth_inside(faces, local).max(initial=-1.0)) < _DEEP_M for faces in self._faces)
