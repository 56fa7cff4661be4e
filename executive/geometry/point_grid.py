"""Nearest points of a set, looked up in columns of a grid of cells.

A tree halves space until few points are left; points of a surface that were thinned to one density
need no tree: a query looks at the cells about it, which lie one after another in memory.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Float, Int, read_only

_MOST_CELLS = 2_000_000  # 16 MB: wider sets get coarser cells
_PER_POINT = 64  # cells for each point, so that few points make no large grid
_COARSER = 1.25  # factor of the edge until there are not too many cells
_FEW = 16  # points of a column that are looked at in less time than it takes to find its cells


class Cells(NamedTuple):
    """Points sorted by cell, x, then y, then z.

    Attributes:
        points: [m], shape (N, 3).
        rows: Which of the given points each is, shape (N,).
        firsts: Where each cell begins among them, and at last their number, shape (C + 1,), in half
            the memory of other numbers of rows.
        low: Lower corner of the grid [m], shape (3,).
        spans: Number of cells along each axis.
        cell_m: Edge of a cell [m].
    """

    points: Float
    rows: Int
    firsts: NDArray[np.int32]
    low: Float
    spans: tuple[int, int, int]
    cell_m: float


class PointGrid:
    """Finds the nearest of many points, for many queries."""

    def __init__(self, points: Float, cell_m: float) -> None:
        """Sort points into cells; an edge of two to four distances of neighbours is fastest.

        Args:
            points: Positions [m], shape (N, 3).
            cell_m: Edge of a cell [m]; larger where the set is wide.
        """
        even = read_only(np.asarray(points, dtype=np.float64))
        low, spans = np.zeros(3), np.zeros(3)
        if len(even):
            low, spans = _bounds(even)
        most = max(min(_MOST_CELLS, _PER_POINT * len(even)), 1)
        edge_m, (wide, deep, high) = float(cell_m), spans.tolist()
        while True:
            counts = (int(wide / edge_m) + 1, int(deep / edge_m) + 1, int(high / edge_m) + 1)
            if counts[0] * counts[1] * counts[2] <= most:
                break
            edge_m *= _COARSER
        sorted_points, rows, firsts = _sorted(even, low, counts, edge_m)
        self._cells = Cells(sorted_points, rows, firsts, low, counts, edge_m)

    def nearest(self, queries: Float, reach_m: float) -> tuple[Float, Int]:
        """Return the distance of the nearest point [m] and its row, each of shape (M,).

        Args:
            queries: Positions [m], shape (M, 3).
            reach_m: Points as far as this and farther are none; the distance is then inf, and the
                row N.
        """
        distances, rows = self._nearest(queries, 1, reach_m)
        return distances[:, 0], rows[:, 0]

    def several(self, queries: Float, count: int) -> tuple[Float, Int]:
        """Return the distances of the nearest points [m] and their rows, the nearest first, each of
        shape (M, count); inf and N where there are fewer points.
        """
        return self._nearest(queries, count, np.inf)

    def distances_m(self, queries: Float, count: int) -> Float:
        """Return the distances of the nearest points as `several` does, shape (M, count)."""
        return self.several(queries, count)[0]

    def _nearest(self, queries: Float, count: int, reach_m: float) -> tuple[Float, Int]:
        asked = read_only(np.asarray(queries, dtype=np.float64))
        distances, rows = _nearest(asked, count, float(reach_m), self._cells)
        return distances, rows


def compile_point_grid() -> None:
    """Compile the inner loops, so that no cloud has to wait for them."""
    PointGrid(np.zeros((1, 3)), 1.0).nearest(np.zeros((1, 3)), 1.0)


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _bounds(points: Float) -> tuple[Float, Float]:
    """Return the lower corner of points and their extents [m]."""
    low, high = points[0].copy(), points[0].copy()
    for n in range(len(points)):
        for a in range(3):
            low[a], high[a] = min(low[a], points[n, a]), max(high[a], points[n, a])
    return low, high - low


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _sorted(
    points: Float, low: Float, spans: tuple[int, int, int], cell_m: float
) -> tuple[Float, Int, NDArray[np.int32]]:
    """Return the first three of `Cells`."""
    ends = np.zeros(spans[0] * spans[1] * spans[2] + 1, dtype=np.int32)
    cells = np.empty(len(points), dtype=np.int64)
    for n in range(len(points)):
        cell = 0
        for a in range(3):
            cell = cell * spans[a] + min(int((points[n, a] - low[a]) / cell_m), spans[a] - 1)
        cells[n] = cell
        ends[cell] += 1
    for cell in range(1, len(ends)):
        ends[cell] += ends[cell - 1]
    rows, even = np.empty(len(points), dtype=np.int64), np.empty((len(points), 3))
    for n in range(len(points) - 1, -1, -1):
        ends[cells[n]] -= 1
        place = ends[cells[n]]
        rows[place] = n
        for a in range(3):
            even[place, a] = points[n, a]
    return even, rows, ends


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _nearest(  # one function, since a call for each column takes three times as long
    queries: Float, count: int, reach_m: float, cells: Cells
) -> tuple[Float, Int]:
    """Look at growing squares of columns about each query; see `PointGrid.nearest`.

    Returns:
        Distances of so many points, the nearest first [m], shape (M, count), and their rows.
    """
    points, names, firsts, low, (nx, ny, nz), cell_m = cells
    squares = np.full((len(queries), count), np.inf)
    rows = np.full((len(queries), count), len(points))
    for n in range(len(queries)):
        x, y, z = queries[n, 0] - low[0], queries[n, 1] - low[1], queries[n, 2] - low[2]
        i, j = int(np.floor(x / cell_m)), int(np.floor(y / cell_m))
        # To the borders of the query's own column: the next ring is so far away at least.
        inner = max(x - i * cell_m, (i + 1) * cell_m - x, y - j * cell_m, (j + 1) * cell_m - y)
        worst = reach_m * reach_m
        ring = max(-i, i - nx + 1, -j, j - ny + 1, 0)  # the first that meets the grid
        last_ring = max(i, nx - 1 - i, j, ny - 1 - j)
        while ring <= last_ring and max(ring * cell_m - inner, 0.0) ** 2 < worst:
            for a in range(max(i - ring, 0), min(i + ring + 1, nx)):
                step = 1 if abs(a - i) == ring else max(2 * ring, 1)
                dx = max(a * cell_m - x, x - (a + 1) * cell_m, 0.0)
                for b in range(j - ring, j + ring + 1, step):
                    dy = max(b * cell_m - y, y - (b + 1) * cell_m, 0.0)
                    left = worst - dx * dx - dy * dy
                    if b < 0 or b >= ny or left <= 0.0:
                        continue
                    column = (a * ny + b) * nz
                    first, last = firsts[column], firsts[column + nz]
                    if last - first > _FEW:
                        half = np.sqrt(left)
                        under = int(min(max(np.floor((z - half) / cell_m), 0.0), nz))
                        above = int(max(min(np.floor((z + half) / cell_m) + 1.0, nz), 0.0))
                        first, last = firsts[column + under], firsts[column + above]
                    for k in range(first, last):
                        u = points[k, 0] - queries[n, 0]
                        v = points[k, 1] - queries[n, 1]
                        w = points[k, 2] - queries[n, 2]
                        square = u * u + v * v + w * w
                        if square >= worst:
                            continue
                        m = count - 1
                        while m > 0 and squares[n, m - 1] > square:
                            squares[n, m], rows[n, m] = squares[n, m - 1], rows[n, m - 1]
                            m -= 1
                        squares[n, m], rows[n, m] = square, names[k]
                        worst = min(worst, squares[n, count - 1])
            ring += 1
    return np.sqrt(squares), rows
