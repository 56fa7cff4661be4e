"""Places that the lidars see through, although the map has something there.

A ray that ends well behind a place has passed through it, so that nothing stands there any more.
Places are cubes of four voxels' edge, each with the mean of its returns. A scan pair sees through a
place if no return falls into it, and a ray that ends farther away passes closely by its mean:

- within the noise of a return, or
- within half a cube, if no return falls into a neighbouring cube either. A ring of rays may pass
  just over the edge of a stone that stands still, but then the ring below it ends on the stone.

A place is forgotten after some scan pairs in a row have seen through it. What is occluded is passed
by no ray and stays. Own addition to the method of the paper, whose map only grows.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Float, Int

VOXELS = 4  # along the edge of a place
_NEAR_M = 0.02  # range noise of a lidar, one standard deviation
_MEMORY = 100  # returns over which a mean is taken
_EVERY = 3  # ray is followed, others at the next pair: they lie far closer than places
_FIRST_COUNT = 1 << 14
Ids = NDArray[np.int32]


class Carver:
    """Counts how often each place about the machine was seen through."""

    def __init__(self, voxel_m: float, radius_m: float, margin_m: float, after: int) -> None:
        """Start with nothing known.

        Args:
            voxel_m: Edge of the map's voxels [m].
            radius_m: Of the region about the machine, which is as high as wide [m].
            margin_m: Distance behind a place at which a ray must end to have passed through it [m].
            after: Scan pairs in a row until a place is forgotten.
        """
        self._edge_m, self._margin_m, self._after = VOXELS * voxel_m, margin_m, after
        self._half = int(np.ceil(radius_m / self._edge_m)) + 1
        self._pair = 0
        self.begin(np.zeros(3), np.empty((0, 3)))

    @classmethod
    def compile(cls) -> None:
        """Compile the inner loops."""
        warm_up = cls(0.05, 1.0, 0.1, 1)
        warm_up.see([(np.zeros(3), np.full((1, 3), 0.5))])

    def begin(self, centre_map: Float, points_map: Float) -> None:
        """Begin anew about a centre, with the points that the map has there [m], shape (N, 3)."""
        self._low = np.floor(centre_map / self._edge_m).astype(np.int64) - self._half
        self._ids = np.full((2 * self._half,) * 3, -1, dtype=np.int32)
        self._cells = np.empty((_FIRST_COUNT, 3), dtype=np.int64)
        self._means = np.zeros((_FIRST_COUNT, 3))
        # rows: returns, pair of the last return, pair of the last miss, misses in a row
        self._counts = np.zeros((_FIRST_COUNT, 4), dtype=np.int64)
        self._used = 0
        self._hit(points_map)
        self._counts[: self._used, 1] = -1

    def see(self, views: list[tuple[Float, Float]]) -> Int:
        """Take in one scan pair.

        Args:
            views: For each lidar its position [m], shape (3,), and its returns in the map [m],
                shape (N, 3).

        Returns:
            Lowest voxel index of each place to forget, shape (K, 3).
        """
        self._pair += 1
        for _, points in views:
            self._hit(points)
        gone = np.concatenate(
            [
                _walk(
                    origin,
                    points,
                    self._low,
                    self._ids,
                    self._means,
                    self._counts,
                    (self._edge_m, self._margin_m),
                    (self._pair, self._after),
                )
                for origin, points in views
            ]
            or [np.empty(0, dtype=np.int64)]
        )
        return np.asarray(self._cells[gone] * VOXELS)

    def add(self, points_map: Float) -> None:
        """Take in points that were not seen now but are known to be there [m], shape (N, 3)."""
        self._hit(points_map)

    def _hit(self, points: Float) -> None:
        if self._used + len(points) > len(self._cells):
            more = max(len(self._cells), len(points))
            self._cells = np.vstack([self._cells, np.empty((more, 3), dtype=np.int64)])
            self._means = np.vstack([self._means, np.zeros((more, 3))])
            self._counts = np.vstack([self._counts, np.zeros((more, 4), dtype=np.int64)])
        self._used = _hit(
            points,
            self._low,
            self._ids,
            self._cells,
            self._means,
            self._counts,
            self._edge_m,
            (self._used, self._pair),
        )


@njit(cache=True)  # type: ignore[untyped-decorator]
def _hit(  # noqa: PLR0913 - arrays of one table
    points: Float,
    low: Int,
    ids: Ids,
    cells: Int,
    means: Float,
    counts: Int,
    edge_m: float,
    used_and_pair: tuple[int, int],
) -> int:  # pragma: no cover - compiled
    """Add returns to their places; return how many places there are now."""
    used, pair = used_and_pair
    for n in range(len(points)):
        i = int(np.floor(points[n, 0] / edge_m)) - low[0]
        j = int(np.floor(points[n, 1] / edge_m)) - low[1]
        k = int(np.floor(points[n, 2] / edge_m)) - low[2]
        if not (0 <= i < ids.shape[0] and 0 <= j < ids.shape[1] and 0 <= k < ids.shape[2]):
            continue
        place = ids[i, j, k]
        if place < 0:
            place = used
            ids[i, j, k] = used
            cells[used] = (i + low[0], j + low[1], k + low[2])
            counts[used] = 0
            used += 1
        counts[place, 0] += 1
        counts[place, 1] = pair
        counts[place, 3] = 0
        weight = min(counts[place, 0], _MEMORY)
        for axis in range(3):
            means[place, axis] += (points[n, axis] - means[place, axis]) / weight
    return used


@njit(cache=True)  # type: ignore[untyped-decorator]
def _walk(  # noqa: PLR0913 - arrays of one table
    origin: Float,
    points: Float,
    low: Int,
    ids: Ids,
    means: Float,
    counts: Int,
    lengths_m: tuple[float, float],
    pair_and_after: tuple[int, int],
) -> Int:  # pragma: no cover - compiled
    """Follow each ray through the places (Amanatides and Woo 1987); return those to forget."""
    edge_m, margin_m = lengths_m
    pair, after = pair_and_after
    gone, count = np.empty(len(ids) * 16, dtype=np.int64), 0
    cell, step = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    ahead, stride = np.empty(3), np.empty(3)
    for n in range(pair % _EVERY, len(points), _EVERY):
        ray = points[n] - origin
        length = np.sqrt((ray * ray).sum())
        if length <= margin_m:
            continue
        ray /= length
        for a in range(3):
            place_in = origin[a] / edge_m
            cell[a] = int(np.floor(place_in)) - low[a]
            step[a] = 1 if ray[a] > 0 else -1
            stride[a] = edge_m / abs(ray[a]) if abs(ray[a]) > 1e-12 else np.inf
            before = place_in - np.floor(place_in)
            rest = 1.0 - before if ray[a] > 0 else before
            ahead[a] = rest * stride[a] if stride[a] < np.inf else np.inf
        travelled = 0.0
        while travelled < length - margin_m:
            place = _place(ids, cell)
            if place >= 0 and counts[place, 1] != pair and counts[place, 2] != pair:
                offset = means[place] - origin
                along = (offset * ray).sum()
                aside = np.sqrt(max((offset * offset).sum() - along * along, 0.0))
                is_behind = along < length - margin_m
                if is_behind and (
                    aside < _NEAR_M
                    or (aside < edge_m / 2 and not _is_hit_nearby(ids, counts, cell, pair))
                ):
                    counts[place, 2] = pair
                    counts[place, 3] += 1
                    if counts[place, 3] >= after and count < len(gone):
                        gone[count] = place
                        count += 1
                        ids[cell[0], cell[1], cell[2]] = -1
            a = int(np.argmin(ahead))
            travelled = ahead[a]
            cell[a] += step[a]
            ahead[a] += stride[a]
    return gone[:count]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _place(ids: Ids, cell: Int) -> int:
    """Return the place in a cell; −1 if there is none."""  # pragma: no cover - compiled
    for a in range(3):
        if cell[a] <= 0 or cell[a] >= ids.shape[a] - 1:
            return -1
    return int(ids[cell[0], cell[1], cell[2]])


@njit(cache=True)  # type: ignore[untyped-decorator]
def _is_hit_nearby(ids: Ids, counts: Int, cell: Int, pair: int) -> bool:
    """Return whether a return of this pair fell into one of the 26 neighbours."""
    # pragma: no cover - compiled
    for i in range(cell[0] - 1, cell[0] + 2):
        for j in range(cell[1] - 1, cell[1] + 2):
            for k in range(cell[2] - 1, cell[2] + 2):
                if ids[i, j, k] >= 0 and counts[ids[i, j, k], 1] == pair:
                    return True
    return False
