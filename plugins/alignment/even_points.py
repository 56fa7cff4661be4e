"""The points of a thinned surface: the nearest of them, and how far they are apart."""

from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from executive.arrays import Float, Int
from executive.geometry.point_grid import PointGrid

_CELL = 3.0  # edge of the cells in which points are looked up, in that of the thinning: fastest
_NEAR = 6.0  # farther than so many edges a tree is faster, and few points are
_ASKED = 500  # points whose neighbours are looked for


class EvenPoints:
    """Points of about one density."""

    def __init__(self, points: Float, voxel_m: float) -> None:
        """Prepare the search among points (N, 3) that were thinned to a grid [m]."""
        self._points, self._near_m = points, _NEAR * voxel_m
        self._grid = PointGrid(points, _CELL * voxel_m)

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self._points)

    def nearest(self, queries: Float) -> Int:
        """Return the row of the nearest point of each query, (M, 3) → (M,)."""
        rows = self._grid.nearest(queries, self._near_m)[1]
        far = np.flatnonzero(rows == len(self._points))
        if len(far):
            rows[far] = self._tree.query(queries[far])[1]
        return rows

    def spacing_m(self, neighbours: int) -> float:
        """Return the edge of the square that each point has to itself, its median [m].

        A point has as many neighbours as it asks for in a disc; each takes an equal part of its
        area.
        """
        count = min(neighbours, len(self._points) - 1)
        if count < 1:
            return 0.0
        asked = self._points[:: max(len(self._points) // _ASKED, 1)]
        radii_m = self._grid.distances_m(asked, count + 1)[:, count]
        return float(np.median(radii_m) * np.sqrt(np.pi / count))
