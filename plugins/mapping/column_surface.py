"""The surface in a map of columns: smoothed, then thinned to one point a voxel.

With a lidar's range noise of 2 cm, one surface covers two or three layers of 3 cm voxels, which
averaging within voxels does not merge. Averaged over 4.5 cm, the layers coincide, and thinning
leaves one. The cost: sharp edges are rounded by about a centimetre.
"""

from typing import NamedTuple

import numpy as np
from executive_plugins.mapping.column_store import BIN, BITS, SMOOTH, Columns, Pool
from numba import njit

from executive.arrays import Float, Int

_HALF = 1 << (BITS - 1)


class Choice(NamedTuple):
    """How points are smoothed and which belong to the cloud.

    Attributes:
        voxel_m: Edge of a voxel [m].
        reach_m: Radius of smoothing [m]; at most one voxel in each direction is used; 0: none.
        memory: Number of points beyond which a voxel has no more weight.
        least: Number of points from which a voxel counts as occupied.
        centre_map: Middle of the cylinder in which points are kept [m], shape (3,).
        radius_m: Its radius and half its height [m].
    """

    voxel_m: float
    reach_m: float
    memory: int
    least: int
    centre_map: Float
    radius_m: float


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def smooth(columns: Columns, pool: Pool, choice: Choice) -> None:  # pragma: no cover - compiled
    """Smooth the marked columns anew, from the lowest voxel up, beside their eight neighbours.

    A mean moves towards its neighbours' means, weighted by their points and their nearness.
    """
    across, marks = columns.spans[1], columns.marks
    first, held = columns.first, columns.held
    heights, counts, means, moved = pool.heights, pool.counts, pool.means, pool.moved
    square, memory = choice.reach_m * choice.reach_m, choice.memory
    starts, ends = np.empty(9, dtype=np.int64), np.empty(9, dtype=np.int64)
    for c in range(len(held)):
        if not marks[c] & SMOOTH or held[c] == 0:
            continue
        if square == 0.0:
            moved[first[c] : first[c] + held[c]] = means[first[c] : first[c] + held[c]]
            continue
        used = 0
        for k in range(9):
            beside = c + (k // 3 - 1) * across + k % 3 - 1
            if held[beside]:
                starts[used], ends[used] = first[beside], first[beside] + held[beside]
                used += 1
        for n in range(first[c], first[c] + held[c]):
            here_x, here_y, here_z = means[n, 0], means[n, 1], means[n, 2]
            lowest, highest = heights[n] - 1, heights[n] + 1
            x, y, z, total = 0.0, 0.0, 0.0, 0.0
            for k in range(used):
                at, end = starts[k], ends[k]
                while at < end and heights[at] < lowest:
                    at += 1
                starts[k] = at
                while at < end and heights[at] <= highest:
                    dx, dy, dz = means[at, 0] - here_x, means[at, 1] - here_y, means[at, 2] - here_z
                    nearness = 1.0 - (dx * dx + dy * dy + dz * dz) / square
                    weight = min(counts[at], memory) * max(nearness, 0.0)
                    x += weight * dx
                    y += weight * dy
                    z += weight * dz
                    total += weight
                    at += 1
            moved[n, 0] = here_x + x / total
            moved[n, 1] = here_y + y / total
            moved[n, 2] = here_z + z / total
    _settle(columns, pool, choice)


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _settle(columns: Columns, pool: Pool, choice: Choice) -> None:  # pragma: no cover - compiled
    """Find the voxels into which the smoothed points fall: their own or one beside it."""
    moved, counts, cells, into = pool.moved, pool.counts, pool.cells, pool.beside
    voxel_m, centre, square = choice.voxel_m, choice.centre_map, choice.radius_m**2
    low_i, low_j, across = columns.low[0] - _HALF, columns.low[1] - _HALF, columns.spans[1]
    for c in range(len(columns.held)):
        if not columns.marks[c] & SMOOTH:
            continue
        own_i, own_j = c // across + low_i, c % across + low_j
        sends = 0
        for n in range(columns.first[c], columns.first[c] + columns.held[c]):
            x, y, z = moved[n, 0], moved[n, 1], moved[n, 2]
            cells[n] = int(np.floor(z / voxel_m)) + _HALF
            di, dj = int(np.floor(x / voxel_m)) - own_i, int(np.floor(y / voxel_m)) - own_j
            di, dj = min(max(di, -1), 1), min(max(dj, -1), 1)  # farther only by rounding
            dx, dy, dz = x - centre[0], y - centre[1], z - centre[2]
            is_in = dx * dx + dy * dy < square and abs(dz) < choice.radius_m
            is_kept = is_in and counts[n] >= choice.least
            into[n] = 3 * (di + 1) + dj + 1 if is_kept else -1
            if is_kept:
                sends |= 1 << into[n]
        columns.sends[c] = sends


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def thin(  # noqa: C901 - a call that hands the arrays on costs more than the work
    columns: Columns, pool: Pool, voxels: int, old_points: Float, old_first: Int
) -> tuple[Float, Int]:  # pragma: no cover - compiled
    """Return the mean of the smoothed points in each voxel, in order of the voxels.

    Columns without a mark are copied from the points of before.

    Args:
        columns: The window; its marks are cleared.
        pool: Smoothed voxels.
        voxels: An upper bound of the number of points.
        old_points: The points of before [m], shape (N, 3).
        old_first: Row of the first point of each column, and the number of all, shape (C + 1,).

    Returns:
        The points [m] (M, 3), and the row of each column's first, as `old_first`.
    """
    points = np.empty((voxels, 3))
    first = np.empty(len(columns.held) + 1, dtype=np.int64)
    marks, begins, held = columns.marks, columns.first, columns.held
    sends, moved, cells, into = columns.sends, pool.moved, pool.cells, pool.beside
    sums, numbers = np.zeros((64, 3)), np.zeros(64, dtype=np.int64)
    gathered = np.empty(64, dtype=np.int64)
    found, c = 0, 0
    while c < len(held):
        begin, shift = c, found - old_first[c]
        while c < len(held) and not marks[c] & BIN:
            first[c] = old_first[c] + shift
            c += 1
        count = old_first[c] - old_first[begin]
        points[found : found + count] = old_points[old_first[begin] : old_first[c]]
        found += count
        if c == len(held):
            break
        marks[c] = 0
        first[c] = found
        number, low, high = 0, 1 << BITS, -1
        for k in range(9):
            beside = c + (k // 3 - 1) * columns.spans[1] + k % 3 - 1
            if not sends[beside] >> (8 - k) & 1:
                continue
            for n in range(begins[beside], begins[beside] + held[beside]):
                if into[n] == 8 - k:
                    if number == len(gathered):
                        gathered = np.append(gathered, gathered)
                    gathered[number] = n
                    number += 1
                    low, high = min(low, cells[n]), max(high, cells[n])
        if high - low >= len(sums):
            sums = np.zeros((2 * (high - low + 1), 3))
            numbers = np.zeros(len(sums), dtype=np.int64)
        for n in gathered[:number]:
            numbers[cells[n] - low] += 1
            for axis in range(3):
                sums[cells[n] - low, axis] += moved[n, axis]
        for cell in range(high - low + 1):
            if numbers[cell] > 0:
                for axis in range(3):
                    points[found, axis] = sums[cell, axis] / numbers[cell]
                    sums[cell, axis] = 0.0
                numbers[cell] = 0
                found += 1
        c += 1
    first[c] = found
    return points[:found], first


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def count_columns(
    columns: Columns, pool: Pool, least: int, centre: Float, reach: int
) -> Int:  # pragma: no cover - compiled
    """Return the number of columns with a voxel of `least` points in each square metre.

    Args:
        columns: The window.
        pool: Voxels.
        least: Number of points from which a voxel counts as occupied.
        centre: Where four square metres meet [m], shape (2,).
        reach: Half the square's side [m].

    Returns:
        Along x and y, shape (2 reach, 2 reach).
    """
    counts = np.zeros((2 * reach, 2 * reach), dtype=np.int64)
    for c in range(len(columns.held)):
        for n in range(columns.first[c], columns.first[c] + columns.held[c]):
            if pool.counts[n] >= least:
                i = int(np.floor(pool.means[n, 0] - centre[0])) + reach
                j = int(np.floor(pool.means[n, 1] - centre[1])) + reach
                if 0 <= i < 2 * reach and 0 <= j < 2 * reach:
                    counts[i, j] += 1
                break
    return counts
