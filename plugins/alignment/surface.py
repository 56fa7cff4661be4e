"""A surface that is given by thinned points: the nearest of them, and its plane at each."""

from typing import NamedTuple

import numpy as np
from executive_plugins.alignment.tangent_planes import tangent_planes
from scipy.spatial import cKDTree

from executive.arrays import Float, Int
from executive.geometry.point_grid import PointGrid
from executive.geometry.voxels import voxel_means

_CELL = 3.0  # edge of the cells in which points are looked up, in that of the thinning: fastest
_NEAR = 6.0  # farther than so many edges a tree is faster, and few points are
HOLDS = 0.5  # how far a plane holds, in the radius of the points that shape it
# Half a disc, as at the edge of a surface, is 1.9 times as long as wide. Neighbours that are more
# elongated lie along one line of a lidar, whose noise then turns the plane about the line.
_LONGEST = 2.0
_MORE = 4  # as many times as many neighbours reach the next lines, or there is no plane


class Planes(NamedTuple):
    """Planes through the neighbours of points.

    Attributes:
        normals: Unit normals, shape (M, 3).
        radii_m: Distance of the farthest point that shapes each plane [m]; 0 where the neighbours
            make no plane, shape (M,).
    """

    normals: Float
    radii_m: Float


class Surface:
    """Points of about one density, and the planes through their neighbours.

    A plane is fitted when it is first asked for: of a large target few points are ever met.

    Attributes:
        points: Thinned [m], shape (N, 3).
        near_m: The search is fast as far as this [m].
    """

    def __init__(self, points: Float, voxel_m: float, neighbours: int) -> None:
        """Prepare the search among points (N, 3) that were thinned to a grid [m]."""
        self.points, self.near_m = points, _NEAR * voxel_m
        self._neighbours = min(neighbours, len(points))
        self._grid = PointGrid(points, _CELL * voxel_m)
        self._tree: cKDTree | None = None
        self._planes = Planes(np.zeros((len(points), 3)), np.zeros(len(points)))
        self._is_fitted = np.zeros(len(points), dtype=np.bool_)

    @classmethod
    def thinned(cls, points: Float, voxel_m: float, neighbours: int) -> "Surface":
        """Thin points to a grid."""
        return cls(voxel_means(points, voxel_m), voxel_m, neighbours)

    def __len__(self) -> int:
        return len(self.points)

    def within(self, queries: Float, reach_m: float) -> tuple[Float, Int]:
        """Return the distance [m] and row of the nearest point; inf and N where it is farther."""
        return self._grid.nearest(queries, reach_m)

    def nearest(self, queries: Float) -> Int:
        """Return the row of the nearest point of each query, (M, 3) → (M,)."""
        rows = self._grid.nearest(queries, self.near_m)[1]
        far = np.flatnonzero(rows == len(self.points))
        if len(far):
            self._tree = self._tree or cKDTree(self.points)
            rows[far] = self._tree.query(queries[far])[1]
        return rows

    def planes(self, rows: Int) -> Planes:
        """Return the planes at some points, shape (M,)."""
        is_asked = np.zeros(len(self.points), dtype=np.bool_)
        is_asked[rows] = True
        self._fit(np.flatnonzero(is_asked & ~self._is_fitted), self._neighbours)
        self._is_fitted |= is_asked
        return Planes(self._planes.normals.take(rows, axis=0), self._planes.radii_m.take(rows))

    def _fit(self, rows: Int, neighbours: int) -> None:
        """Fit planes to so many neighbours, and to more where these lie along a line."""
        distances, beside = self._grid.several(self.points.take(rows, axis=0), neighbours)
        normals, elongations = tangent_planes(self.points, beside)
        is_plane = elongations <= _LONGEST
        self._planes.normals[rows] = normals
        self._planes.radii_m[rows] = np.where(is_plane, distances[:, -1], 0.0)
        most = min(_MORE * self._neighbours, len(self.points))
        if neighbours < most and not is_plane.all():
            self._fit(rows[~is_plane], min(2 * neighbours, most))
