"""The region around the machine that is mapped, R_map (Mascaro 2020, Sec. 4.2)."""

import numpy as np

from executive.arrays import Bool, Float

# Motion of the machine at which the cylinder follows; with a smaller value, the swing of the cabin
# would cause the grid to be rebuilt.
_STRIDE_M = 0.5


class Cylinder:
    """A cylinder around the machine, as high as wide, that follows the machine in steps."""

    def __init__(self, radius_m: float) -> None:
        self._radius_m = radius_m
        self.centre_map = np.zeros(3)

    def follow(self, position_map: Float) -> bool:
        """Move the centre if the machine has moved far enough; return whether it was moved."""
        if np.linalg.norm(position_map - self.centre_map) <= _STRIDE_M:
            return False
        self.centre_map = position_map
        return True

    def contains(self, points_map: Float) -> Bool:
        """Return which points lie within, shape (N, 3) → (N,)."""
        offset = points_map - self.centre_map
        is_near = (offset[:, :2] ** 2).sum(axis=1) < self._radius_m**2
        return np.asarray(is_near & (np.abs(offset[:, 2]) < self._radius_m))
