"""The ground that a machine may drive on, and what stands on it, from a cloud."""

import numpy as np
from executive_plugins.driving.settings import GroundSettings
from scipy.ndimage import binary_dilation, grey_dilation, grey_erosion

from executive.arrays import Bool, Float, Int

_NONE = 1e6  # height of a cell without a point, upwards or downwards [m]


class DrivableGround:
    """Heights of the ground on a grid, which cells are seen, and the points above the ground.

    The ground is the morphological opening of the lowest points of the cells: what rises and is
    narrower than the opening is no ground. A plane of any slope is kept as it is.

    Source: Zhang et al. 2003, A progressive morphological filter for removing nonground
    measurements from airborne lidar data, Sec. III, with a single window.

    Attributes:
        obstacles_map: Points higher above the ground than a step of the machine, shape (N, 3).
    """

    def __init__(
        self,
        points_map: Float,
        around: tuple[Float, Float],
        step_m: float,
        settings: GroundSettings,
    ) -> None:
        """Take a cloud.

        Args:
            points_map: Ground, stones and obstacles [m], shape (N, 3).
            around: Least and largest x and y of the area that counts, shape (2,) each.
            step_m: What is at most so high above the ground is driven over [m].
            settings: The grid.
        """
        self._s, self._low = settings, np.asarray(around[0])
        self._shape = tuple(
            int(n) for n in np.ceil((np.asarray(around[1]) - self._low) / settings.cell_m) + 1
        )
        within = ((points_map[:, :2] >= around[0]) & (points_map[:, :2] <= around[1])).all(axis=1)
        points = points_map[within]
        cells = self._cells(points[:, :2])
        lowest = np.full(self._shape, _NONE)
        np.minimum.at(lowest, (cells[:, 0], cells[:, 1]), points[:, 2])
        is_seen = lowest < _NONE
        self._heights = self._opened(lowest)
        wide = 2 * round(settings.beside_m / settings.cell_m) + 1
        self._is_seen = (
            binary_dilation(is_seen, np.ones((wide, wide))) if is_seen.any() else is_seen
        )
        above = points[:, 2] - self._heights[cells[:, 0], cells[:, 1]]
        self.obstacles_map = points[above > step_m]

    def vouch(self, place_map: Float, radius_m: float) -> None:
        """Take the ground about a place (2,) for seen."""
        x, y = (self._low[i] + np.arange(n) * self._s.cell_m for i, n in enumerate(self._shape))
        away = np.hypot(x[:, None] - place_map[0], y[None, :] - place_map[1])
        self._is_seen = self._is_seen | (away <= radius_m)

    def heights(self, places_map: Float) -> Float:
        """Return the ground height at places (..., 2) [m]; NaN where none is known."""
        cells = self._cells(places_map)
        heights = self._heights[cells[..., 0], cells[..., 1]]
        return np.where(np.abs(heights) < _NONE / 2, heights, np.nan)

    def is_seen(self, places_map: Float) -> Bool:
        """Return whether the ground is seen at places (..., 2); beyond the area it is not."""
        cells = self._cells(places_map)
        beyond = np.abs(places_map - self._low - cells * self._s.cell_m) > self._s.cell_m
        return np.asarray(self._is_seen[cells[..., 0], cells[..., 1]] & ~beyond.any(axis=-1))

    def _cells(self, places: Float) -> Int:
        cells = np.rint((places - self._low) / self._s.cell_m).astype(np.int64)
        return np.clip(cells, 0, np.array(self._shape) - 1)

    def _opened(self, lowest: Float) -> Float:
        size = 2 * int(np.ceil(0.5 * self._s.widest_object_m / self._s.cell_m)) + 1
        eroded = grey_erosion(lowest, size=(size, size), mode="nearest")
        known = np.where(eroded < _NONE / 2, eroded, -_NONE)
        opened = grey_dilation(known, size=(size, size), mode="nearest")
        return np.asarray(np.minimum(opened, lowest))
