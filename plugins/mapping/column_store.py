"""The voxels of a grid by upright columns, so that what changed is found beside its neighbours.

Columns lie in a dense window around the machine, row by row along y. The voxels of a column lie
side by side in a pool, from the lowest up, with some room to grow.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Float, Int

BITS = 21  # a voxel's index along an axis; three of them fill 63 bits
INDEX = (1 << BITS) - 1
FREE = -1  # the key of a row without a voxel
EDGE = 3  # empty columns around the window: neighbours of neighbours of any voxel are inside
CHANGED, SMOOTH, BIN = 4, 2, 1  # marks of columns: what has to be done anew
_ROOM = 1  # free voxels of each column when it is laid out
_MOST = np.iinfo(np.int32).max
Narrow = NDArray[np.int32]
Marks = NDArray[np.uint8]


class Table(NamedTuple):
    """The hash table of a voxel grid: keys, counts of points (R,), and means [m] (R, 3)."""

    keys: Int
    counts: Int
    means: Float


class Columns(NamedTuple):
    """Where each column's voxels are in the pool.

    Attributes:
        low: Voxel indices of the window's first column, shape (2,).
        spans: Columns of the window along x and y, shape (2,).
        first: Place of a column's lowest voxel, shape (C,).
        held: Number of its voxels, shape (C,).
        room: Number of voxels for which it has room, shape (C,).
        marks: What has to be done anew, shape (C,).
        sends: Into which columns its smoothed points fall: bit k for the k-th of the nine around
            it, row by row, shape (C,).
    """

    low: Int
    spans: Int
    first: Narrow
    held: Narrow
    room: Narrow
    marks: Marks
    sends: NDArray[np.uint16]


class Pool(NamedTuple):
    """Voxels, column by column.

    Attributes:
        heights: Voxel indices along z, rising within a column, shape (P,).
        counts: Numbers of points, shape (P,).
        means: Mean points [m], shape (P, 3).
        moved: The same after smoothing [m], shape (P, 3).
        cells: Voxel index along z of the smoothed point, shape (P,).
        beside: The column of the smoothed point, 0 … 8 among the neighbours; −1 if it is no point
            of the cloud, shape (P,).
    """

    heights: Narrow
    counts: Narrow
    means: Float
    moved: Float
    cells: Narrow
    beside: NDArray[np.int8]


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def extent(table: Table) -> tuple[Int, Int, int]:  # pragma: no cover - compiled
    """Return the lowest and highest column of any voxel (2,), and the number of voxels."""
    low, high = np.full(2, 1 << BITS), np.full(2, -1)
    voxels = 0
    for row in range(len(table.keys)):
        key = table.keys[row]
        if key != FREE and table.counts[row] > 0:
            voxels += 1
            i, j = key >> (2 * BITS), (key >> BITS) & INDEX
            low[0], high[0] = min(low[0], i), max(high[0], i)
            low[1], high[1] = min(low[1], j), max(high[1], j)
    return low, high, voxels


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def fill(table: Table, columns: Columns, pool: Pool) -> int:  # pragma: no cover - compiled
    """Lay out all voxels anew, and mark all columns; return the used part of the pool."""
    keys, counts, means = table.keys, table.counts, table.means  # a tuple would be counted anew at
    first, held, room = columns.first, columns.held, columns.room  # each use
    low_i, low_j, across = columns.low[0], columns.low[1], columns.spans[1]
    held[:] = 0
    for row in range(len(keys)):
        if keys[row] != FREE and counts[row] > 0:
            held[
                ((keys[row] >> (2 * BITS)) - low_i) * across
                + (((keys[row] >> BITS) & INDEX) - low_j)
            ] += 1
    used = 0
    for c in range(len(held)):
        room[c] = held[c] + _ROOM if held[c] > 0 else 0
        first[c], held[c] = used, 0
        used += room[c]
    for row in range(len(keys)):
        if keys[row] != FREE and counts[row] > 0:
            c = ((keys[row] >> (2 * BITS)) - low_i) * across + (
                ((keys[row] >> BITS) & INDEX) - low_j
            )
            height, at = keys[row] & INDEX, first[c] + held[c]
            while at > first[c] and pool.heights[at - 1] > height:
                _copy(pool.heights, pool.counts, pool.means, at - 1, at)
                at -= 1
            pool.heights[at], pool.counts[at] = height, min(counts[row], _MOST)
            pool.means[at, 0], pool.means[at, 1] = means[row, 0], means[row, 1]
            pool.means[at, 2] = means[row, 2]
            held[c] += 1
    _mark_all(columns.marks, columns.spans)
    return used


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _mark_all(marks: Marks, spans: Int) -> None:  # pragma: no cover - compiled
    """Mark all columns but those at the rim, which have no neighbours and stay empty."""
    marks[:] = 0
    for i in range(1, spans[0] - 1):
        marks[i * spans[1] + 1 : (i + 1) * spans[1] - 1] = SMOOTH


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def refresh(  # noqa: C901 - a call that hands the arrays on costs more than the work
    changed: Int, table: Table, columns: Columns, pool: Pool, used: int
) -> int:  # pragma: no cover - compiled
    """Take over some rows of the table; return the used part of the pool.

    −1 if a voxel is outside of the window or the pool is full: then all has to be laid out anew.
    """
    keys, counts, means = table.keys, table.counts, table.means
    first, held, room, marks = columns.first, columns.held, columns.room, columns.marks
    heights, numbers, places = pool.heights, pool.counts, pool.means
    low, spans = columns.low, columns.spans
    for row in changed:
        i, j = (keys[row] >> (2 * BITS)) - low[0], ((keys[row] >> BITS) & INDEX) - low[1]
        if i < EDGE or j < EDGE or i >= spans[0] - EDGE or j >= spans[1] - EDGE:
            return -1
        c, height = i * spans[1] + j, keys[row] & INDEX
        at, end = first[c], first[c] + held[c]
        while at < end and heights[at] < height:
            at += 1
        is_there = at < end and heights[at] == height
        if not is_there and counts[row] == 0:
            continue
        if not marks[c] & CHANGED:
            marks[c] |= CHANGED
            _mark(marks, c, spans[1])
        if counts[row] == 0:
            held[c] -= 1
            for n in range(at, end - 1):
                _move(pool, n + 1, n)
            continue
        if not is_there:
            if held[c] == room[c]:
                if used + 2 * held[c] + 2 > len(heights):
                    return -1
                at += used - first[c]
                for n in range(held[c]):
                    _move(pool, first[c] + n, used + n)
                first[c], room[c] = used, 2 * held[c] + 2
                used += room[c]
            for n in range(first[c] + held[c], at, -1):
                _move(pool, n - 1, n)
            held[c] += 1
            heights[at] = height
        numbers[at] = min(counts[row], _MOST)
        for axis in range(3):
            places[at, axis] = means[row, axis]
    return used


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _mark(marks: Marks, c: int, across: int) -> None:  # pragma: no cover - compiled
    """Smooth a column and those beside it anew."""
    for di in range(-1, 2):
        for dj in range(-1, 2):
            marks[c + di * across + dj] |= SMOOTH


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _copy(
    heights: Narrow, counts: Narrow, means: Float, here: int, there: int
) -> None:  # pragma: no cover - compiled
    heights[there], counts[there] = heights[here], counts[here]
    for axis in range(3):
        means[there, axis] = means[here, axis]


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _move(pool: Pool, here: int, there: int) -> None:  # pragma: no cover - compiled
    """Move a voxel within the pool, with what is known of its smoothed point."""
    _copy(pool.heights, pool.counts, pool.means, here, there)
    pool.cells[there], pool.beside[there] = pool.cells[here], pool.beside[here]
    for axis in range(3):
        pool.moved[there, axis] = pool.moved[here, axis]
