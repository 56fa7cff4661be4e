"""One cloud's stones and ground, prepared to be compared with another cloud under many motions."""

from functools import cached_property

import numpy as np
from executive_plugins.registration.constellation import level_pose
from executive_plugins.registration.similarity import Surface
from executive_plugins.registration.thinning import thinned

from executive.arrays import Bool, Float, Int
from executive.geometry.pose import transform
from executive.messages.segment import Segmentation

_GROUND_VOXEL_M = 0.10  # density of the ground's points
_CELL_M = 0.25  # cells in which it is told whether plain ground was seen
_LEAST_COUNT = 3  # points that make a cell seen
_RELIEF_M = 1.0  # edge of the squares whose mean heights are compared
_LEAST_RELIEF_COUNT = 16  # points that give a square a height


class SiteView:
    """Surfaces of the stones, and where plain ground was seen beside them.

    Attributes:
        stones: The surface of each segment, in the order of the segmentation.
        spacing_m: Distance of their points [m].
    """

    def __init__(self, seen: Segmentation, spacing_m: float) -> None:
        """Prepare a cloud; `spacing_m` is the distance of the points of a stone's surface [m]."""
        self.spacing_m = spacing_m
        self.stones = [Surface.thinned(one.points, spacing_m) for one in seen.segments]
        self._seen = seen
        self._T_level_cloud = level_pose(seen.ground_plane)

    @cached_property
    def ground(self) -> Float:
        """Points of the ground, thinned [m], shape (N, 3)."""
        return thinned(self._seen.ground.points, _GROUND_VOXEL_M)

    @cached_property
    def _relief(self) -> tuple[Int, Float]:
        return _heights_of(transform(self._T_level_cloud, self.ground))

    @cached_property
    def _plain(self) -> tuple[Int, Bool]:
        """The first cell, and which cells show the ground and nothing on it, shape (nx, ny)."""
        cells = self._cells(self.ground)
        rising = np.vstack([self._cells(stone.points) for stone in self.stones])
        both = np.vstack([cells, rising])
        low = both.min(axis=0)
        shape = both.max(axis=0) - low + 1
        counts = np.zeros(shape, dtype=np.int64)
        np.add.at(counts, tuple((cells - low).T), 1)
        counts[tuple((rising - low).T)] = 0
        return low, counts >= _LEAST_COUNT

    def share_on_plain_ground(self, points_cloud: Float) -> float:
        """Return which share of the cells under some points shows the ground and nothing on it.

        Points are in this cloud's frame [m], shape (N, 3).
        """
        low, is_plain = self._plain
        cells = np.unique(self._cells(points_cloud), axis=0) - low
        inside = ((cells >= 0) & (cells < is_plain.shape)).all(axis=1)
        return float(is_plain[tuple(cells[inside].T)].sum() / max(len(cells), 1))

    def relief_errors(self, ground_cloud: Float) -> Float:
        """Return by how much another ground is higher than this one [m], a value a square metre.

        Only square metres that both show count. Points are in this cloud's frame, shape (N, 3).
        """
        keys, heights = self._relief
        others, theirs = _heights_of(transform(self._T_level_cloud, ground_cloud))
        _, mine, others_rows = np.intersect1d(keys, others, return_indices=True)
        return np.asarray(theirs[others_rows] - heights[mine])

    def _cells(self, points_cloud: Float) -> Int:
        places = transform(self._T_level_cloud, points_cloud)[:, :2]
        return np.asarray(np.floor(places / _CELL_M).astype(np.int64))


def _heights_of(points_level: Float) -> tuple[Int, Float]:
    """Return keys of square metres with enough ground, and their mean heights [m]."""
    cells = np.floor(points_level[:, :2] / _RELIEF_M).astype(np.int64)
    keys, rows, counts = np.unique(
        (cells[:, 0] << 32) + cells[:, 1], return_inverse=True, return_counts=True
    )
    heights = np.bincount(rows, weights=points_level[:, 2], minlength=len(keys)) / np.maximum(
        counts, 1
    )
    enough: Bool = counts >= _LEAST_RELIEF_COUNT
    return keys[enough], heights[enough]
