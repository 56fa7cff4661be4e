"""Splitting of clusters that hold several stones.

Deviation from Mascaro 2020, Sec. 4.3, where one distance separates objects: a distance that holds a
thinly sampled stone together joins neighbours up to 14 cm apart. Here, each cluster is split on a
finer grid and by valleys of its upper surface. A split is accepted if each part has the size of a
stone and the parts hold nearly all points of the cluster.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.segmentation.clusters import connected_clusters
from executive_plugins.segmentation.shape import spans
from executive_plugins.segmentation.watershed import basins
from scipy.spatial import cKDTree

from executive.arrays import Bool, Float, Int

# voxels to the fourth neighbour; parts of one stone had 1.6 to 2.4, whole neighbours 0.8 to 1.5
_DENSE = 1.5


@dataclass(frozen=True, slots=True)
class ClusterSplitter:
    """Splits clusters into stones.

    Attributes:
        fine_voxel_m: Grid edge of the finer clustering [m].
        cell_m: Grid edge of the view from above [m].
        least_drop: From a summit to the pass between two, as a share of the lower summit's height.
        least_points: Fewest points of a stone.
        least_extent_m: Smallest longest side of a stone [m].
        least_height_m: Smallest height of a stone [m].
        least_share: Smallest share of a cluster's points that its parts must hold; the other points
            are then assigned to the nearest part.
    """

    fine_voxel_m: float
    cell_m: float
    least_drop: float
    least_points: int
    least_extent_m: float
    least_height_m: float
    least_share: float

    def count_tops(self, places: Float, heights: Float) -> int:
        """Return how many summits a part has, seen from above; arguments as in `split`."""
        return len(np.unique(basins(places, heights, self.cell_m, self.least_drop, self._cells)))

    @property
    def _cells(self) -> int:
        return int(0.25 * (self.least_extent_m / self.cell_m) ** 2)

    def split(self, points: Float, places: Float, heights: Float) -> list[Int]:
        """Return the rows of each stone's points in a cluster; all rows at once if it is one stone.

        Args:
            points: [m], shape (N, 3).
            places: Their positions along the ground [m], shape (N, 2).
            heights: Above the ground [m], shape (N,).
        """
        fine = connected_clusters(points, np.zeros(len(points), dtype=np.int64), self.fine_voxel_m)
        found = []
        for part in self._believed(fine, points, heights):
            where, above = places.take(part, axis=0), heights[part]
            valley = basins(where, above, self.cell_m, self.least_drop, self._cells)
            believed = self._believed(valley, points.take(part, axis=0), above)
            found += [part[rows] for rows in believed]
        return found

    def _believed(self, labels: Int, points: Float, heights: Float) -> list[Int]:
        counts = np.bincount(labels)
        cores = [int(c) for c in np.flatnonzero(counts >= self.least_points)]
        if len(cores) >= 2:
            cores = [c for c in cores if self._is_stone(labels == c, points, heights)]
        if len(cores) >= 2:
            cores = [c for c in cores if self._is_dense(points[labels == c])]
        if len(cores) < 2 or counts[cores].sum() < self.least_share * len(points):
            return [np.arange(len(points))]
        names = np.full(len(counts), -1)
        names[cores] = np.arange(len(cores))
        owner = names[labels]
        rest = owner < 0
        if rest.any():
            owner[rest] = owner[~rest][cKDTree(points[~rest]).query(points[rest])[1]]
        return [np.flatnonzero(owner == k) for k in range(len(cores))]

    def _is_stone(self, rows: Bool, points: Float, heights: Float) -> bool:
        part = points[rows]
        return bool(
            heights[rows].max() >= self.least_height_m and spans(part).max() >= self.least_extent_m
        )

    def _is_dense(self, part: Float) -> bool:
        """Return whether points are dense, so that a gap beside them is not just thin sampling.

        They are if most of them have four others within 1.5 voxels.
        """
        some = part[:: max(len(part) // 200, 1)]
        fourth = cKDTree(part).query(some, k=5)[0][:, 4]
        return bool(np.median(fourth) < _DENSE * self.fine_voxel_m)
