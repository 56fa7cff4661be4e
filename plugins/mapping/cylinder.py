"""The region around the machine that is mapped, R_map (Mascaro 2020, Sec. 4.2)."""

import numpy as np

from executive.arrays import Bool, Float

# of the machine, before the cylinder follows: less would rebuild the grid for the swing's wobble
_STRIDE_M = 0.5


class Cylinder:
    """A cylinder about the machine, in height as far as in width, that follows it in strides."""

    def __init__(self, radius_m: float) -> None:
        self._radius_m = radius_m
        self._centre_map = np.zeros(3)

    def follow(self, position_map: Float) -> bool:
        """Move with the machine, now and then; say whether it has."""
        if np.linalg.norm(position_map - self._centre_map) <= _STRIDE_M:
            return False
        self._centre_map = position_map
        return True

    def contains(self, points_map: Float) -> Bool:
        """Tell which points lie within, shape (N, 3) → (N,)."""
        offset = points_map - self._centre_map
        is_near = (offset[:, :2] ** 2).sum(axis=1) < self._radius_m**2
        return np.asarray(is_near & (np.abs(offset[:, 2]) < self._radius_m))
