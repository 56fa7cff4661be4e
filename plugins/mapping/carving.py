"""Places that the lidars see through, although the map has something there.

Rays that end well behind a place have passed it, so that nothing stands there any more. Places are
cubes of four voxels' edge, each with the mean of its returns. A scan pair sees through a place if
no return falls into it, and rays that end farther away pass on both of its sides, no farther apart
than the smallest thing that is to be kept; see `range_image`.

Whether something is there is known by its log-odds (Hornung et al. 2013, Sec. III-A): each pair
that sees through a place takes an equal share away, all of it after some in a row, and a return
makes it certain again, for hardly anything else returns rays. What is occluded is passed by no ray
and stays. Own addition to the method of the paper, whose map only grows.

A place without returns, which a scan pair of the last seconds saw to be empty, and into which
returns fall now, is one that something came into. Such places, and those that are seen through at
present, hold what moves.
"""

import numpy as np
from executive_plugins.mapping.earlier_views import EarlierViews
from executive_plugins.mapping.range_image import RangeImage, nearest_returns, passed_on_both_sides
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Float, Int
from executive.messages.moving_places import MovingPlaces

VOXELS = 4  # along the edge of a place
_MEMORY = 100  # returns over which a mean is taken
_FIRST_COUNT = 1 << 14
_FORGOTTEN = -1  # in place of the misses in a row of a place
_FEW = 1024  # rows of forgotten places that are left alone
_NEVER = -(1 << 40)  # pair in which something came into a place where nothing was seen to come
Ids = NDArray[np.int32]


class Carver:
    """Counts how often each place about the machine was seen through."""

    def __init__(
        self,
        voxel_m: float,
        radius_m: float,
        margin_m: float,
        after: int,
        smallest_m: float,
        standing_after: int,
    ) -> None:
        """Start with nothing known.

        Args:
            voxel_m: Edge of the map's voxels [m].
            radius_m: Of the region about the machine, which is as high as wide [m].
            margin_m: Distance behind a place at which a ray must end to have passed through it [m].
            after: Scan pairs in a row until a place is forgotten.
            smallest_m: Width of the smallest thing that is kept between two rays [m].
            standing_after: Scan pairs after which what came into a place counts as standing there.
        """
        self._edge_m, self._margin_m, self._after = VOXELS * voxel_m, margin_m, after
        self._smallest_m, self._standing_after = smallest_m, standing_after
        self._earlier = EarlierViews(standing_after, smallest_m, margin_m)
        self._half = int(np.ceil(radius_m / self._edge_m)) + 1
        self._pair = 0
        self.begin(np.zeros(3), np.empty((0, 3)))

    @classmethod
    def compile(cls) -> None:
        """Compile the inner loops."""
        warm_up = cls(0.05, 1.0, 0.1, 1, 0.25, 1)
        for side_m in (0.5, -0.5):
            warm_up.see([(np.zeros(3), np.full((1, 3), side_m))])

    def begin(self, centre_map: Float, points_map: Float) -> None:
        """Begin anew about a centre, with the points that the map has there [m], shape (N, 3)."""
        self._low = np.floor(centre_map / self._edge_m).astype(np.int64) - self._half
        self._ids = np.full((2 * self._half,) * 3, -1, dtype=np.int32)
        self._cells = np.empty((_FIRST_COUNT, 3), dtype=np.int64)
        self._means = np.zeros((_FIRST_COUNT, 3))
        # rows: returns, pair of the last return, pair of the last miss, misses in a row, pair in
        # which something came
        self._counts = np.zeros((_FIRST_COUNT, 5), dtype=np.int64)
        self._used = self._forgotten = 0
        self._earlier.clear()
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
        first = self._used
        for _, points in views:
            self._hit(points)
        came = self._earlier.saw_empty(self._means[first : self._used])
        self._counts[first : self._used, 4][came] = self._pair
        seen = [(origin, nearest_returns(origin, points)) for origin, points in views]
        self._earlier.add(self._pair, seen)
        for origin, image in seen:
            _look_beside(
                origin,
                image,
                self._means,
                self._counts[: self._used],
                (self._smallest_m, self._margin_m),
                self._pair,
            )
        gone = np.flatnonzero(self._counts[: self._used, 3] >= self._after)
        self._ids[tuple((self._cells[gone] - self._low).T)] = -1
        self._counts[gone, 3] = _FORGOTTEN
        self._forgotten += len(gone)
        corners = np.asarray(self._cells[gone] * VOXELS)
        if self._forgotten > max(_FEW, self._used // 2):
            self._close_gaps()
        return corners

    def add(self, points_map: Float) -> None:
        """Take in points that were not seen now but are known to be there [m], shape (N, 3)."""
        self._hit(points_map)

    def moving(self) -> MovingPlaces:
        """Return the places that something came into, or that are seen through at present."""
        counts = self._counts[: self._used]
        is_new = counts[:, 4] > self._pair - self._standing_after
        is_left = (counts[:, 3] > 0) & (counts[:, 2] == self._pair)
        return MovingPlaces(self._edge_m, self._cells[: self._used][is_new | is_left])

    def _close_gaps(self) -> None:
        """Take the forgotten places out of the table: one that is seen again gets another row."""
        left = np.flatnonzero(self._counts[: self._used, 3] != _FORGOTTEN)
        for table in (self._cells, self._means, self._counts):
            table[: len(left)] = table[left]
        self._used, self._forgotten = len(left), 0
        self._ids[tuple((self._cells[: len(left)] - self._low).T)] = np.arange(len(left))

    def _hit(self, points: Float) -> None:
        if self._used + len(points) > len(self._cells):
            more = max(len(self._cells), len(points))
            self._cells = np.vstack([self._cells, np.empty((more, 3), dtype=np.int64)])
            self._means = np.vstack([self._means, np.zeros((more, 3))])
            self._counts = np.vstack([self._counts, np.zeros((more, 5), dtype=np.int64)])
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
            counts[used, 4] = _NEVER
            used += 1
        counts[place, 0] += 1
        counts[place, 1] = pair
        counts[place, 3] = 0
        weight = min(counts[place, 0], _MEMORY)
        for axis in range(3):
            means[place, axis] += (points[n, axis] - means[place, axis]) / weight
    return used


@njit(cache=True)  # type: ignore[untyped-decorator]
def _look_beside(
    origin: Float,
    image: RangeImage,
    means: Float,
    counts: Int,
    lengths_m: tuple[float, float],
    pair: int,
) -> None:  # pragma: no cover - compiled
    """Count the misses of places that rays pass on both sides."""
    for place in range(len(counts)):
        if counts[place, 1] == pair or counts[place, 2] == pair or counts[place, 3] == _FORGOTTEN:
            continue
        if passed_on_both_sides(image, origin, means[place], lengths_m[0], lengths_m[1]):
            counts[place, 2] = pair
            counts[place, 3] += 1
