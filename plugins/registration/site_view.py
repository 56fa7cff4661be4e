"""One cloud's stones and ground, prepared to be compared with another cloud under many motions."""

from functools import cached_property

import numpy as np
from executive_plugins.registration.constellation import level_pose
from executive_plugins.registration.similarity import Surface
from executive_plugins.registration.thinning import thinned
from numba import njit
from scipy.ndimage import distance_transform_edt

from executive.arrays import Bool, Float, Int
from executive.geometry.pose import transform
from executive.messages.segment import Segmentation

_GROUND_VOXEL_M = 0.10  # density of the ground's points
_CELL_M = 0.25  # cells in which it is told whether plain ground was seen
_MOST_CELLS = 1_000_000  # 250 m × 250 m: those of wider sites are larger, as their points are few
_LEAST_COUNT = 3  # ninths of a cell with points that make it seen
_RELIEF_M = 1.0  # edge of the squares whose mean heights are compared
_LEAST_RELIEF_COUNT = 16  # points that give a square a height


def compile_site_view() -> None:
    """Compile the inner loop, for ground of a cloud, which may not be written to, and of a part."""
    few, shown = np.zeros((1, 3)), np.zeros((1, 3))
    shown.flags.writeable = False
    for ground in (few, shown):
        _plain_cells(np.eye(4), ground, few)
        thinned(ground, _GROUND_VOXEL_M)
    _at(np.zeros((1, 2), dtype=np.int64), np.zeros(2, dtype=np.int64), np.zeros((1, 1)), 0.0)


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
    def _plain(self) -> tuple[Int, Bool, Float, float]:
        """The first cell, which cells show the ground and nothing on it, and how high each is
        covered [m]: up to the top of a stone; −inf on plain ground, +inf where nothing is seen. At
        last the edge of a cell [m].
        """
        T = self._T_level_cloud
        stones = np.vstack([stone.points for stone in self.stones])
        ground = np.ascontiguousarray(self._seen.ground.points)
        low, is_plain, tops, cell_m = _plain_cells(T, ground, stones)
        return low, is_plain, tops, cell_m

    @cached_property
    def _clearances_m(self) -> Float:
        """By how much each cell is farther from the next cell that is no plain ground than a point
        in it may be from its middle [m]; beyond the border nothing was seen.
        """
        is_plain = np.pad(self._plain[1], 1)
        apart = distance_transform_edt(is_plain)[1:-1, 1:-1] - 1.0 - np.sqrt(0.5)
        return np.asarray(apart * self._plain[3])

    def clearance_m(self, points_cloud: Float) -> Float:
        """Return how far around each point plain ground was seen, at least [m], shape (N,).

        It is negative where it was not. Points are in this cloud's frame [m], shape (N, 3).
        """
        return np.asarray(
            _at(self._cells(points_cloud), self._plain[0], self._clearances_m, -np.inf)
        )

    @cached_property
    def discs(self) -> tuple[Float, Float]:
        """A middle of each stone [m], shape (N, 3), and the distance of its farthest point from it
        [m], shape (N,).
        """
        middles = np.array([stone.points.mean(axis=0) for stone in self.stones])
        reaches = [
            np.sqrt(((stone.points - middle) ** 2).sum(axis=1).max())
            for stone, middle in zip(self.stones, middles, strict=True)
        ]
        return middles, np.array(reaches)

    @cached_property
    def sizes(self) -> Int:
        """Number of points of each stone's surface, shape (N,)."""
        return np.array([len(stone.points) for stone in self.stones], dtype=np.int64)

    def is_open(self, points_cloud: Float, margin_m: float) -> Bool:
        """Return where this cloud shows that nothing is, shape (N,).

        That is above plain ground, and above the top of a stone by more than a margin [m]; what is
        lower than that top is inside the stone or hidden by it. Points are in this cloud's frame
        [m], shape (N, 3).
        """
        low, _, tops, cell_m = self._plain
        places = transform(self._T_level_cloud, points_cloud)
        covered = _at(_cells_of(places, cell_m), low, tops, np.inf)
        return np.asarray(places[:, 2] > covered + margin_m)

    def share_on_plain_ground(self, points_cloud: Float) -> float:
        """Return which share of the cells under some points shows the ground and nothing on it.

        Points are in this cloud's frame [m], shape (N, 3).
        """
        low, is_plain, *_ = self._plain
        cells = self._cells(points_cloud) - low
        width = np.ptp(cells[:, 1]) + 1 if len(cells) else 1
        first = np.unique(cells[:, 0] * width + cells[:, 1], return_index=True)[1]
        plain = _at(cells[first], np.zeros(2, dtype=np.int64), is_plain.astype(np.float64), 0.0)
        return float(plain.sum() / max(len(first), 1))

    def relief_errors(self, ground_cloud: Float) -> Float:
        """Return by how much another ground is higher than this one [m], a value a square metre.

        Only square metres that both show count. Points are in this cloud's frame, shape (N, 3).
        """
        keys, heights = self._relief
        others, theirs = _heights_of(transform(self._T_level_cloud, ground_cloud))
        _, mine, others_rows = np.intersect1d(keys, others, return_indices=True)
        return np.asarray(theirs[others_rows] - heights[mine])

    def _cells(self, points_cloud: Float) -> Int:
        return _cells_of(transform(self._T_level_cloud, points_cloud), self._plain[3])


def _cells_of(places: Float, cell_m: float) -> Int:
    return np.asarray(np.floor(places[:, :2] / cell_m).astype(np.int64))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _at(cells: Int, low: Int, values: Float, outside: float) -> Float:
    """Return the values of cells, shape (N,), from a grid whose first cell is given (2,); those of
    cells outside of it are given.
    """
    found = np.full(len(cells), outside)
    for n in range(len(cells)):
        i, j = cells[n, 0] - low[0], cells[n, 1] - low[1]
        if 0 <= i < values.shape[0] and 0 <= j < values.shape[1]:
            found[n] = values[i, j]
    return found


@njit(cache=True)  # type: ignore[untyped-decorator]
def _plain_cells(T: Float, ground: Float, stones: Float) -> tuple[Int, Bool, Float, float]:
    """Return the first cell, which cells are plain, how high each is covered, and the edge of a
    cell; see `_plain`.

    A cell is plain if points lie in `_LEAST_COUNT` of its nine parts, and none of a stone.
    """
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    _widen(low, high, T, ground)
    _widen(low, high, T, stones)
    cell_m = max(_CELL_M, np.sqrt((high[0] - low[0]) * (high[1] - low[1]) / _MOST_CELLS))
    first = np.floor(low / cell_m).astype(np.int64)
    shape = np.floor(high / cell_m).astype(np.int64) - first + 1
    seen, counts = np.zeros((shape[0], shape[1], 9), dtype=np.bool_), np.zeros((shape[0], shape[1]))
    tops = np.full((shape[0], shape[1]), -np.inf)
    for n in range(len(stones)):
        u, v = _level(T, stones, n, 0) / cell_m, _level(T, stones, n, 1) / cell_m
        i, j = int(u - first[0]), int(v - first[1])
        tops[i, j] = max(tops[i, j], _level(T, stones, n, 2))
    for n in range(len(ground)):
        u = _level(T, ground, n, 0) / cell_m - first[0]
        v = _level(T, ground, n, 1) / cell_m - first[1]
        i, j = int(u), int(v)
        part = 3 * min(int(3 * (u - i)), 2) + min(int(3 * (v - j)), 2)
        counts[i, j] += not seen[i, j, part]
        seen[i, j, part] = True
    is_plain = (counts >= _LEAST_COUNT) & (tops == -np.inf)
    for i in range(shape[0]):
        for j in range(shape[1]):
            if not is_plain[i, j] and tops[i, j] == -np.inf:
                tops[i, j] = np.inf
    return first, is_plain, tops, cell_m


@njit(cache=True)  # type: ignore[untyped-decorator]
def _level(T: Float, points: Float, n: int, axis: int) -> float:
    """Return a coordinate of a moved point, each time anew: all together would take much memory."""
    x, y, z = points[n, 0], points[n, 1], points[n, 2]
    place: float = T[axis, 0] * x + T[axis, 1] * y + T[axis, 2] * z + T[axis, 3]
    return place


@njit(cache=True)  # type: ignore[untyped-decorator]
def _widen(low: Float, high: Float, T: Float, points: Float) -> None:
    """Widen the corners of a box seen from above, so that it holds moved points, in place."""
    for n in range(len(points)):
        for a in range(2):
            place = _level(T, points, n, a)
            low[a], high[a] = min(low[a], place), max(high[a], place)


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
