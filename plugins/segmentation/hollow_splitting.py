"""Splitting of clusters by gaps and valleys first, then by planes between convex bodies, and of
what is hollow still along its concave borders; slivers along seams are given back at last.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.segmentation.cluster_splitting import ClusterSplitter
from executive_plugins.segmentation.convex_splitting import ConvexSplitter
from executive_plugins.segmentation.plane_splitting import PlaneSplitter
from executive_plugins.segmentation.seam_slivers import SeamSlivers

from executive.arrays import Float, Int


@dataclass(frozen=True, slots=True)
class HollowSplitter:
    """Splits clusters by what is cheap, and checks that each part is one stone.

    Attributes:
        by_gaps: Splits by gaps and valleys.
        by_planes: Splits what is more likely two bodies that touch than one.
        by_convexity: Splits what is hollow or too long for one stone.
        slivers: Gives what cuts leave over along seams to the stones beside it.
    """

    by_gaps: ClusterSplitter
    by_planes: PlaneSplitter
    by_convexity: ConvexSplitter
    slivers: SeamSlivers

    def count_tops(self, places: Float, heights: Float) -> int:
        """Return how many summits a part has, seen from above; arguments as in `split`."""
        return self.by_gaps.count_tops(places, heights)

    def split(self, points: Float, places: Float, heights: Float) -> list[Int]:
        """Return the rows of each stone's points in a cluster; arguments as in
        `ClusterSplitter.split`.
        """
        level = np.column_stack([places, heights])
        found = list[Int]()
        for part in self.by_gaps.split(points, places, heights):
            for body in self.by_planes.split(level.take(part, axis=0)):
                rows = part[body]
                surface = points.take(rows, axis=0)
                if self.by_convexity.is_one(surface):
                    found.append(rows)
                else:
                    where = places.take(rows, axis=0)
                    parts = self.by_convexity.split(surface, where, heights[rows])
                    found += [rows[inner] for inner in parts]
        return self.slivers.given_back(level, found)
