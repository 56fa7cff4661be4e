"""Whether a machine may stand at each pose of a path: ground seen, not too steep, and free."""

import numpy as np
from executive_plugins.driving.drivable_ground import DrivableGround
from executive_plugins.driving.footprint import Footprint
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.machine.machine import Machine
from executive.messages.drive import DriveTrouble

_EVERY_M = 0.4  # between poses that are checked
_VOXEL_M = 0.1  # of obstacles: one point each
_BEARING = 4  # least number of seen places below the machine for a plane


class PathCheck:
    """Checks poses against the map.

    Args:
        machine: What drives.
        foot: The space that it needs.
        ground: What it drives on.
        T_map_base: Where it stands now: ground that is unseen there continues this plane.
        least_seen: Least share of the ground below the machine that is seen.
    """

    def __init__(
        self,
        machine: Machine,
        foot: Footprint,
        ground: DrivableGround,
        T_map_base: Float,
        least_seen: float,
    ) -> None:
        self._machine, self._foot, self._ground = machine, foot, ground
        self._T_map_base, self._least_seen = T_map_base, least_seen
        cells = np.floor(ground.obstacles_map / _VOXEL_M).astype(np.int64)
        _, first = np.unique(cells, axis=0, return_index=True)
        self._obstacles = ground.obstacles_map[np.sort(first)]
        self._tree = cKDTree(self._obstacles[:, :2]) if len(self._obstacles) else None

    def trouble(self, poses_map: Float) -> tuple[DriveTrouble, str] | None:
        """Return what is in the way of a path of densely sampled poses (n, 3), or None."""
        ways = np.linalg.norm(np.diff(poses_map[:, :2], axis=0), axis=1)
        every = max(1, round(_EVERY_M / max(float(ways.max(initial=0.0)), 1e-3)))
        for place in [*poses_map[every::every], poses_map[-1]]:
            if (found := self._at(place)) is not None:
                return found
        return None

    def _at(self, place: Float) -> tuple[DriveTrouble, str] | None:
        x, y, yaw = place
        where = f"at ({x:.1f}, {y:.1f})"
        R = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
        below = self._foot.supports @ R.T + (x, y)
        seen = self._ground.is_seen(below)
        if seen.mean() < self._least_seen:
            share = 100 * seen.mean()
            return DriveTrouble.UNSEEN, f"{share:.0f} % of the ground {where} is seen"
        slope = self._slope(below)
        limit = self._machine.driving.max_slope_rad if self._machine.driving else 0.0
        angle = float(np.arctan(np.hypot(*slope[:2])))
        if angle > limit:
            steep, most = np.degrees(angle), np.degrees(limit)
            return DriveTrouble.TOO_STEEP, f"the ground {where} slopes by {steep:.0f}° ({most:.0f})"
        if self._hits(place, slope):
            return DriveTrouble.BLOCKED, f"something stands in the way {where}"
        return None

    def _slope(self, places: Float) -> Float:
        """Return (a, b, c) of the plane z = a x + b y + c through the ground at places (n, 2)."""
        heights = self._ground.heights(places)
        known = np.isfinite(heights)
        if known.sum() < _BEARING:
            up, foot = self._T_map_base[:3, 2], self._T_map_base[:3, 3]
            foot = foot - self._machine.stance.base_height_m * up
            a, b = -up[:2] / up[2]
            return np.array([a, b, foot[2] - a * foot[0] - b * foot[1]])
        matrix = np.c_[places[known], np.ones(int(known.sum()))]
        return np.asarray(np.linalg.lstsq(matrix, heights[known], rcond=None)[0])

    def _hits(self, place: Float, slope: Float) -> bool:
        if self._tree is None:
            return False
        x, y, yaw = place
        up = np.array([-slope[0], -slope[1], 1.0]) / np.sqrt(1 + slope[0] ** 2 + slope[1] ** 2)
        base_m = self._machine.stance.base_height_m
        lean_m = np.hypot(*up[:2]) * (base_m + self._foot.high[:, 2].max())  # of the roof, downhill
        near = self._tree.query_ball_point(place[:2], self._foot.radius_m + lean_m)
        if not near:
            return False
        ahead = np.array([np.cos(yaw), np.sin(yaw), 0.0])
        ahead[2] = slope[:2] @ ahead[:2]
        ahead /= np.linalg.norm(ahead)
        R = np.column_stack([ahead, np.cross(up, ahead), up])
        foot = np.array([x, y, slope @ (x, y, 1.0)])
        T = pose(R, foot + base_m * up)
        return self._foot.hits(transform(inverse(T), self._obstacles[np.sort(near)]))
