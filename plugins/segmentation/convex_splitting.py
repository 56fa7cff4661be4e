"""Splitting of clusters along concave borders: stones that touch or lie on each other.

What was split too finely is joined again: parts that are convex together are one stone with a step
in its surface. What is hollow still is split once more, with a smaller tolerance.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from executive_plugins.segmentation.average_linkage import average_linkage
from executive_plugins.segmentation.hollow import hollow_share, is_hollow
from executive_plugins.segmentation.patch_graph import patch_graph
from executive_plugins.segmentation.shape import principal_extents, spans
from scipy.spatial import cKDTree

from executive.arrays import Float, Int
from executive.geometry.voxels import voxel_means

_EVEN = 4  # points along the edge of a patch: normals need one density, whatever the cloud's
_SURE = 0.8  # of the hollows of one stone: what was split has to be less hollow to be joined
_SOME = 300  # points of a part by which its neighbours are found


@dataclass(frozen=True, slots=True)
class ConvexSplitter:
    """Splits clusters into nearly convex parts.

    Attributes:
        patch_m: Grid edge of the patches [m].
        tolerance_rad: Angle by which a surface of one stone may be concave [rad].
        least_points: Fewest points of a stone.
        least_extent_m: Smallest longest side of a stone [m].
        most_extent_m: Largest longest side of a stone [m].
        most_hollow: Depth under its convex hull of the hollows of one stone, in its longest side.
    """

    patch_m: float
    tolerance_rad: float
    least_points: int
    least_extent_m: float
    most_extent_m: float
    most_hollow: float

    def count_tops(self, places: Float, heights: Float) -> int:
        """Return how many parts a cluster would have; arguments as in `split`."""
        return len(self.split(np.column_stack([places, heights]), places, heights))

    def split(self, points: Float, places: Float, heights: Float) -> list[Int]:
        """Return the rows of each part's points; all rows at once if it is one stone.

        Parts too small for a stone are given to the nearest part that is one.

        Args:
            points: [m], shape (N, 3).
            places: Their positions along the ground [m], shape (N, 2).
            heights: Above the ground [m], shape (N,).
        """
        level = np.ascontiguousarray(np.column_stack([places, heights]))
        return self._joined(level, self._parted(level, (self.tolerance_rad, 0.0)))

    def is_one(self, points: Float) -> bool:
        """Return whether points are no more hollow than one stone, shape (N, 3).

        Half as much is asked of what is too long for one: a boulder or a wall is convex.
        """
        longest_m = float(principal_extents(points)[0])
        most = self.most_hollow * (0.5 if longest_m > self.most_extent_m else 1.0)
        return not is_hollow(points, most, longest_m)

    def _parted(self, level: Float, tolerances_rad: tuple[float, ...]) -> list[Int]:
        """Part points; what is no stone yet is parted again with the next tolerance.

        The last is 0: a border that is not concave is none, or walls would fall into stones.
        """
        found, (tolerance_rad, *others) = list[Int](), tolerances_rad
        for rows in self._once(level, tolerance_rad):
            if others and not self.is_one(level[rows]):
                found += [rows[inner] for inner in self._parted(level[rows], tuple(others))]
            else:
                found.append(rows)
        return found

    def _joined(self, level: Float, parts: list[Int]) -> list[Int]:
        """Join neighbours that are one stone together, those that are least hollow first."""
        parts = list(parts)
        shares = {
            pair: self._share_of(level, *(parts[k] for k in pair))
            for pair in combinations(range(len(parts)), 2)
        }
        while shares:
            (one, other), share = min(shares.items(), key=lambda item: (item[1], item[0]))
            if share > _SURE * self.most_hollow:
                break
            parts[one] = np.sort(np.concatenate([parts[one], parts[other]]))
            parts[other] = np.array([], dtype=np.int64)
            shares = {pair: share for pair, share in shares.items() if other not in pair}
            for pair in shares:
                if one in pair:
                    shares[pair] = self._share_of(level, *(parts[k] for k in pair))
        return [part for part in parts if len(part)]

    def _share_of(self, level: Float, one: Int, other: Int) -> float:
        """Return how hollow two parts are together; infinite if they are no neighbours, or too
        long.
        """
        few = level[other[:: max(len(other) // _SOME, 1)]]
        both = level[np.concatenate([one, other])]
        if (
            cKDTree(level[one]).query(few)[0].min() > self.patch_m
            or principal_extents(both)[0] > self.most_extent_m
        ):
            return np.inf
        return hollow_share(both)

    def _once(self, level: Float, tolerance_rad: float) -> list[Int]:
        even = voxel_means(level, self.patch_m / _EVEN)
        graph = patch_graph(even, self.patch_m)
        weights = graph.angles_rad + tolerance_rad
        groups = average_linkage(int(graph.patch_of.max()) + 1, graph.pairs, weights)
        labels = groups[graph.patch_of][cKDTree(even).query(level)[1]]
        counts = np.bincount(labels)
        cores = [
            c
            for c in np.flatnonzero(counts >= self.least_points)
            if spans(level[labels == c]).max() >= self.least_extent_m
        ]
        if len(cores) < 2:
            return [np.arange(len(level))]
        names = np.full(len(counts), -1)
        names[cores] = np.arange(len(cores))
        owner = names[labels]
        rest = owner < 0
        if rest.any():
            owner[rest] = owner[~rest][cKDTree(level[~rest]).query(level[rest])[1]]
        return [np.flatnonzero(owner == k) for k in range(len(cores))]
