"""The surroundings: a map of the highest points, a map of the ground, and the points."""

from functools import cached_property

import numpy as np
from executive_plugins.motion.ground_heights import ground_heights
from executive_plugins.motion.height_survey import close, survey
from scipy.ndimage import maximum_filter, minimum_filter

from executive.arrays import Bool, Float, Int

_CELL_M = 0.1
_BLOCK = 5  # edge of a block of cells, for quick answers
NEAR_M = 2.0  # beyond the radius of the largest link
_GROUND_CELLS = 5  # window of the lowest point, half a metre
_ROUGH_M = 0.06  # largest height of that point above the ground farther around, if it is ground
_GROUND_M = 0.12  # points up to this height above the ground belong to the ground
_FREE = -1e3  # height of a cell without points [m]


class Obstacles:
    """Points around the machine in the base frame; those beyond a radius are dropped."""

    def __init__(self, points_base: Float, radius_m: float) -> None:
        is_near = (np.abs(points_base[:, 0]) < radius_m) & (np.abs(points_base[:, 1]) < radius_m)
        self.points = points_base[is_near]
        self._radius_m = radius_m
        self._cells = int(np.ceil(2 * radius_m / _CELL_M))
        self._centres = np.asarray(
            (np.arange(self._cells) + 0.5) * _CELL_M - radius_m, dtype=np.float64
        )
        self._heights = self._extremes(np.maximum, _FREE)
        self._floor = self._ground()
        # Samples of a body's surface are up to 1.5 cells apart, hence the maximum over neighbouring
        # cells. Ground in a shadow counts like the ground beside it.
        self._wide = np.maximum(maximum_filter(self._heights, size=3), self._floor)

    def clearances(self, points_base: Float) -> Float:
        """Return heights of points (..., 3) above the highest obstacle nearby [m], shape (...)."""
        column, row = np.moveaxis(self._index(points_base[..., :2]), -1, 0)
        return np.asarray(points_base[..., 2] - self._wide[column, row])

    def survey(self, T_base_links: Float, samples: Float) -> tuple[Bool, Float]:
        """Return where a body is below `clearances` of 0, and its depth in the ground [m].

        Args:
            T_base_links: Poses of the body's link, shape (K, 4, 4).
            samples: Points of its surface in the link [m], shape (S, 3).

        Returns:
            Shapes (K,) and (K,); the depth is −inf where the body is above all obstacles.
        """
        return survey(T_base_links, samples, self._wide, self._floor, self._radius_m, _CELL_M)

    def close(self, T_base_links: Float, sphere: tuple[Float, float]) -> Int:
        """Return the poses in which a body may be below an obstacle, by a sphere about it, rising.

        Args:
            T_base_links: Poses of the body's link, shape (K, 4, 4).
            sphere: Centre in the link and radius of the sphere [m].
        """
        if sphere[1] > NEAR_M:
            return np.arange(len(T_base_links))
        return close(T_base_links, sphere, self._blocks, self._radius_m, _BLOCK * _CELL_M)

    @cached_property
    def _blocks(self) -> Float:
        """Highest obstacles of blocks of cells and of the blocks within `NEAR_M` around them."""
        short = -self._cells % _BLOCK
        padded = np.pad(self._wide, ((0, short), (0, short)), constant_values=_FREE)
        count = len(padded) // _BLOCK
        blocks = padded.reshape(count, _BLOCK, count, _BLOCK).max(axis=(1, 3))
        around = int(np.ceil(NEAR_M / (_BLOCK * _CELL_M)))
        return np.asarray(maximum_filter(blocks, size=2 * around + 1, mode="nearest"))

    def depths_in_ground(self, points_base: Float) -> Float:
        """Return depths of points (..., 3) below the ground [m], negative above it, shape (...).

        The ground is solid at all depths, while its points form a sheet that thin bodies pass
        through.
        """
        column, row = np.moveaxis(self._index(points_base[..., :2]), -1, 0)
        return np.asarray(self._floor[column, row] - points_base[..., 2])

    def highest(self, azimuths_rad: tuple[float, float], radii_m: tuple[float, float]) -> float:
        """Return the height of the highest obstacle in a ring sector around the base's z axis [m].

        Args:
            azimuths_rad: First and last azimuth; the sector runs from the smaller number to the
                larger.
            radii_m: Inner and outer radius.
        """
        azimuth, radius = self._polar
        start, end = sorted(azimuths_rad)
        turned = (azimuth - start) % (2 * np.pi)
        is_in = (radius >= radii_m[0]) & (radius <= radii_m[1]) & (turned <= end - start)
        return float(self._heights[is_in].max(initial=_FREE))

    @cached_property
    def _polar(self) -> tuple[Float, Float]:
        """Azimuths and radii of the cells' centres about the base's z axis."""
        x, y = np.meshgrid(self._centres, self._centres, indexing="ij")
        return np.arctan2(y, x), np.hypot(x, y)

    @cached_property
    def is_ground(self) -> Bool:
        """Mask of the points that are at most slightly above the ground, shape (N,)."""
        return np.asarray(self.depths_in_ground(self.points) > -_GROUND_M)

    def in_box(self, low: Float, high: Float) -> Int:
        """Return the indices of the points in a box that are above the ground, rising."""
        x, y, z = self.points.T
        is_in = (x >= low[0]) & (x <= high[0])
        is_in &= (y >= low[1]) & (y <= high[1])
        is_in &= (z >= low[2]) & (z <= high[2])
        return np.flatnonzero(is_in & ~self.is_ground)

    def _index(self, xy: Float) -> Int:
        cells = np.floor((xy + self._radius_m) / _CELL_M).astype(np.int64)
        return np.clip(cells, 0, self._cells - 1)

    def _ground(self) -> Float:
        """Return the ground height in each cell, `_FREE` where it is unknown.

        It is the lowest point of the cell and its neighbours, moved along the local slope. Where
        that point belongs to a stone, since the ground beside it is in its shadow, or where there
        is none, the height follows from the ground farther around.
        """
        lowest = self._extremes(np.minimum, -_FREE)
        surface = ground_heights(self.points, self._centres)
        is_known = ~np.isnan(surface)
        surface = np.where(is_known, surface, 0.0)
        above = minimum_filter(lowest - surface, size=_GROUND_CELLS)
        is_ground = above <= np.where(is_known, _ROUGH_M, -_FREE / 2)
        return np.where(is_ground, surface + above, np.where(is_known, surface, _FREE))

    def _extremes(self, extreme: np.ufunc, of_none: float) -> Float:
        heights = np.full(self._cells**2, of_none)
        extreme.at(heights, self._cell_of_points, self.points[:, 2])
        return heights.reshape(self._cells, self._cells)

    @cached_property
    def _cell_of_points(self) -> Int:
        column, row = self._index(self.points[:, :2]).T
        return np.asarray(column * self._cells + row)
