"""A named part of the ground."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Bool, Float, checked
from executive.errors import DataError
from executive.geometry.polygon import (
    area_m2,
    contains,
    crosses_itself,
    distance_to_outline,
    outlines_touch,
)


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """A part of the ground, given by its outline from above; its height has no limit.

    Attributes:
        name: Its name in the mission.
        corners_map: Corners of the outline in the map [m], counter-clockwise, shape (N, 2).
    """

    name: str
    corners_map: Float

    def __post_init__(self) -> None:
        corners = checked("corners_map", self.corners_map, None, 2)
        if len(corners) < 3 or crosses_itself(corners) or abs(area_m2(corners)) < 1e-6:
            raise DataError(
                f"region '{self.name}' has an outline of {len(corners)} corners that crosses "
                "itself or encloses nothing"
            )
        if area_m2(corners) < 0:
            corners = checked("corners_map", corners[::-1], None, 2)
        object.__setattr__(self, "corners_map", corners)

    def contains(self, points_map: Float) -> Bool:
        """Return which points lie in the region; only their x and y count, shape (N,)."""
        return contains(self.corners_map, points_map[:, :2])

    def depth_m(self, points_map: Float) -> Float:
        """Return how far each point is from the border [m]; negative outside, shape (N,)."""
        distances = distance_to_outline(self.corners_map, points_map[:, :2])
        return np.where(self.contains(points_map), distances, -distances)

    def touches(self, outline_map: Float, margin_m: float = 0.0) -> bool:
        """Return whether an outline (V, 2) comes into the region, or as near to it as the margin.

        Args:
            outline_map: Corners of a convex outline in the map [m], shape (V, 2).
            margin_m: Distance from the region that still counts [m].
        """
        return outlines_touch(self.corners_map, outline_map, margin_m)
