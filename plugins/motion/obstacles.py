"""The surroundings as a height map for the quick answer, and as points for the exact one."""

import numpy as np
from scipy.ndimage import maximum_filter
from scipy.spatial import cKDTree

from executive.arrays import Bool, Float

_CELL_M = 0.1
_FREE = -1e3  # height of a cell without points [m]


class Obstacles:
    """Points around the machine, in the base frame; those farther than the radius do not matter."""

    def __init__(self, points_base: Float, radius_m: float) -> None:
        near = np.abs(points_base[:, :2]).max(axis=1, initial=0.0) < radius_m if len(points_base) else np.zeros(0, bool)
        self.points = points_base[near]
        self._radius_m = radius_m
        self._cells = int(np.ceil(2 * radius_m / _CELL_M))
        self._heights = self._height_map()
        self._wide = maximum_filter(self._heights, size=3)  # samples of a body's surface are a cell and a half apart

    def clearances(self, points_base: Float) -> Float:
        """Return heights above the highest obstacle in the surrounding cells [m], of points (..., 3)."""
        column, row = np.moveaxis(self._index(points_base[..., :2]), -1, 0)
        return np.asarray(points_base[..., 2] - self._wide[column, row])

    def highest(self, azimuths_rad: tuple[float, float], radii_m: tuple[float, float]) -> float:
        """Return the height of the highest obstacle in a sector of a ring about the base's z axis [m].

        Args:
            azimuths_rad: First and last azimuth; the sector runs from the smaller number to the larger.
            radii_m: Inner and outer radius.
        """
        axis = (np.arange(self._cells) + 0.5) * _CELL_M - self._radius_m
        x, y = np.meshgrid(axis, axis, indexing="ij")
        radius = np.hypot(x, y)
        start, end = sorted(azimuths_rad)
        turned = (np.arctan2(y, x) - start) % (2 * np.pi)
        is_in = (radius >= radii_m[0]) & (radius <= radii_m[1]) & (turned <= end - start)
        return float(self._heights[is_in].max(initial=_FREE))

    def near(self, low: Float, high: Float, excused: Bool | None = None) -> "Neighbourhood":
        """Return the points in a box, for exact tests; without the excused ones."""
        is_in = ((self.points >= low) & (self.points <= high)).all(axis=1)
        return Neighbourhood(self.points[is_in if excused is None else is_in & ~excused])

    def _index(self, xy: Float) -> np.ndarray:
        cells = np.floor((xy + self._radius_m) / _CELL_M).astype(np.int64)
        return np.clip(cells, 0, self._cells - 1)

    def _height_map(self) -> Float:
        heights = np.full((self._cells, self._cells), _FREE)
        column, row = self._index(self.points[:, :2]).T
        np.maximum.at(heights, (column, row), self.points[:, 2])
        return heights


class Neighbourhood:
    """Points near a body, to be asked which of them are close to a place."""

    def __init__(self, points: Float) -> None:
        self._points = points
        self._tree = cKDTree(points) if len(points) else None

    def around(self, centre: Float, radius_m: float) -> Float:
        """Return the points within a radius of a centre, shape (M, 3)."""
        if self._tree is None:
            return self._points
        return np.asarray(self._points[sorted(self._tree.query_ball_point(centre, radius_m))])
