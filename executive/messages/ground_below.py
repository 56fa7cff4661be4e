"""What may carry a held stone on its way: all that lies below it, from above."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float, checked
from executive.geometry.pose import transform

_CELL_M = 0.25
_UNSEEN_M = 1e6  # height of what was not seen: nothing is far above it


@dataclass(frozen=True, slots=True, eq=False)
class GroundBelow:
    """The highest points below a held stone, wherever the gripper carries it.

    Attributes:
        corner: Corner of the first cell in the base frame [m], shape (2,).
        highest_m: Highest point under the stone with the gripper over cell (i, j), in the base
            frame [m], shape (I, J); 1e6 where a part of that was not seen.
        hangs_m: How far the stone reaches below the gripper's origin [m].
    """

    corner: Float
    highest_m: Float
    hangs_m: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "corner", checked("corner", self.corner, 2))
        object.__setattr__(self, "highest_m", checked("highest_m", self.highest_m, None, None))

    def clearance_m(self, T_base_gripper: Float) -> float:
        """Return how far the stone is above all that is below it [m]: far below 0 if unseen."""
        i, j = np.floor((T_base_gripper[:2, 3] - self.corner) / _CELL_M).astype(int)
        if not (0 <= i < len(self.highest_m) and 0 <= j < self.highest_m.shape[1]):
            return -_UNSEEN_M
        return float(T_base_gripper[2, 3] - self.hangs_m - self.highest_m[i, j])


def ground_below(
    points_map: Float, T_base_map: Float, held_gripper: Float, T_base_gripper: Float
) -> GroundBelow:
    """Return it for a stone in the jaws that hangs, and turns about the vertical alone.

    Args:
        points_map: The surroundings without the stone in the map [m], shape (N, 3).
        T_base_map: Pose of the map in the base frame, shape (4, 4).
        held_gripper: The stone's surface in the gripper's frame [m], shape (M, 3).
        T_base_gripper: Pose of the gripper now, shape (4, 4).
    """
    from scipy.ndimage import maximum_filter  # slow to import: reading a mission needs none

    points_base = transform(T_base_map, points_map)
    hanging = transform(T_base_gripper, held_gripper) - T_base_gripper[:3, 3]
    reach_m = float(np.linalg.norm(hanging[:, :2], axis=1).max())
    corner = points_base[:, :2].min(axis=0) if len(points_base) else np.zeros(2)
    cells = np.floor((points_base[:, :2] - corner) / _CELL_M).astype(int)
    highest = np.full(cells.max(axis=0, initial=0) + 1, -np.inf)
    np.maximum.at(highest, tuple(cells.T), points_base[:, 2])
    highest[np.isinf(highest)] = _UNSEEN_M
    wide = 2 * int(np.ceil(reach_m / _CELL_M)) + 1
    under = maximum_filter(highest, size=wide, mode="constant", cval=_UNSEEN_M)
    return GroundBelow(corner, under, float(-hanging[:, 2].min()))
