"""The surface in a map of columns: smoothed, then thinned to one point a voxel.

With a lidar's range noise of 2 cm, one surface covers two or three layers of 3 cm voxels, which
averaging within voxels does not merge. Averaged over 4.5 cm, the layers coincide, and thinning
leaves one. The cost: sharp edges are rounded by about a centimetre.
"""

from typing import NamedTuple

import numpy as np
from executive_plugins.mapping.column_store import BIN, BITS, SMOOTH, Columns, Narrow, Pool
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
def smooth(  # noqa: C901 - a call that hands the arrays on costs more than the work
    columns: Columns, pool: Pool, choice: Choice
) -> None:  # pragma: no cover - compiled
    """Smooth the occupied voxels of marked columns anew, from the lowest up, beside their eight
    neighbours.

    A mean moves towards its neighbours' means, weighted by their points and their nearness. The
    columns into which its points fall, or fell before, are marked to be thinned anew.
    """
    across, marks, sends = columns.spans[1], columns.marks, columns.sends
    first, held = columns.first, columns.held
    heights, counts, means, moved = pool.heights, pool.counts, pool.means, pool.moved
    is_smoothed, memory = choice.reach_m > 0.0, choice.memory
    per_square = 1.0 / (choice.reach_m * choice.reach_m) if is_smoothed else 0.0
    starts, ends = np.empty(9, dtype=np.int64), np.empty(9, dtype=np.int64)
    for c in range(len(held)):
        if not marks[c] & SMOOTH:
            continue
        marks[c] &= BIN
        lowest_n, end_n, used = first[c], first[c] + held[c], 0
        while lowest_n < end_n and counts[lowest_n] < choice.least:
            lowest_n += 1
        for k in range(9 if lowest_n < end_n else 0):  # half of the columns have no occupied voxel
            beside = c + (k // 3 - 1) * across + k % 3 - 1
            if held[beside]:
                starts[used], ends[used] = first[beside], first[beside] + held[beside]
                used += 1
        for n in range(lowest_n, end_n):
            if counts[n] < choice.least:
                continue  # it gives no point
            here_x, here_y, here_z = means[n, 0], means[n, 1], means[n, 2]
            moved[n, 0], moved[n, 1], moved[n, 2] = here_x, here_y, here_z
            if not is_smoothed:
                continue
            lowest, highest = heights[n] - 1, heights[n] + 1
            x, y, z, total = 0.0, 0.0, 0.0, 0.0
            for k in range(used):
                at, end = starts[k], ends[k]
                while at < end and heights[at] < lowest:
                    at += 1
                starts[k] = at
                while at < end and heights[at] <= highest:
                    dx, dy, dz = means[at, 0] - here_x, means[at, 1] - here_y, means[at, 2] - here_z
                    nearness = 1.0 - (dx * dx + dy * dy + dz * dz) * per_square
                    if nearness > 0.0:
                        weight = min(counts[at], memory) * nearness
                        x += weight * dx
                        y += weight * dy
                        z += weight * dz
                        total += weight
                    at += 1
            moved[n, 0] += x / total
            moved[n, 1] += y / total
            moved[n, 2] += z / total
        before = sends[c]
        sends[c] = _settled(c, columns, pool, choice)
        for k in range(9):
            if (before | sends[c]) >> k & 1:
                marks[c + (k // 3 - 1) * across + k % 3 - 1] |= BIN


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _settled(
    c: int, columns: Columns, pool: Pool, choice: Choice
) -> int:  # pragma: no cover - compiled
    """Find the voxels into which a column's smoothed points fall: their own or one beside it.

    Returns:
        The columns that get some; see `Columns.sends`.
    """
    moved, counts, cells, into = pool.moved, pool.counts, pool.cells, pool.beside
    voxel_m, centre, square = choice.voxel_m, choice.centre_map, choice.radius_m**2
    own_i = c // columns.spans[1] + columns.low[0] - _HALF
    own_j = c % columns.spans[1] + columns.low[1] - _HALF
    sends = 0
    for n in range(columns.first[c], columns.first[c] + columns.held[c]):
        into[n] = -1
        if counts[n] < choice.least:
            continue
        x, y, z = moved[n, 0], moved[n, 1], moved[n, 2]
        cells[n] = int(np.floor(z / voxel_m)) + _HALF
        di, dj = int(np.floor(x / voxel_m)) - own_i, int(np.floor(y / voxel_m)) - own_j
        di, dj = min(max(di, -1), 1), min(max(dj, -1), 1)  # farther only by rounding
        dx, dy, dz = x - centre[0], y - centre[1], z - centre[2]
        if dx * dx + dy * dy < square and abs(dz) < choice.radius_m:
            into[n] = 3 * (di + 1) + dj + 1
            sends |= 1 << into[n]
    return sends


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def thin(  # noqa: C901 - a call that hands the arrays on costs more than the work
    columns: Columns, pool: Pool, voxels: int, old_points: Float, first: Narrow
) -> Float:  # pragma: no cover - compiled
    """Return the mean of the smoothed points in each voxel, in order of the voxels, shape (M, 3).

    Columns without a mark are copied from the points of before.

    Args:
        columns: The window; its marks are cleared.
        pool: Smoothed voxels.
        voxels: An upper bound of the number of points.
        old_points: The points of before [m], shape (N, 3).
        first: Row of the first point of each column, and the number of all, shape (C + 1,); brought
            up to date in place.
    """
    points = np.empty((voxels, 3))
    marks, begins, held = columns.marks, columns.first, columns.held
    sends, moved, cells, into = columns.sends, pool.moved, pool.cells, pool.beside
    sums, numbers = np.zeros((64, 3)), np.zeros(64, dtype=np.int64)
    gathered = np.empty(64, dtype=np.int64)
    found, c, across = 0, 0, columns.spans[1]
    while c < len(held):
        begin = first[c]
        shift = found - begin
        while c < len(held) and not marks[c] & BIN:
            first[c] += shift
            c += 1
        count = first[c] - begin
        for row in range(begin, begin + count):  # few at a time: a slice would take longer
            points[found, 0], points[found, 1] = old_points[row, 0], old_points[row, 1]
            points[found, 2] = old_points[row, 2]
            found += 1
        if c == len(held):
            break
        marks[c] = 0
        first[c] = found
        number, low, high = 0, 1 << BITS, -1
        for k in range(9):
            beside = c + (k // 3 - 1) * across + k % 3 - 1
            if not sends[beside] >> (8 - k) & 1:
                continue
            for n in range(begins[beside], begins[beside] + held[beside]):
                if into[n] == 8 - k:
                    if number == len(gathered):
                        gathered = np.append(gathered, gathered)
                    gathered[number] = n
                    number += 1
                    low, high = min(low, cells[n]), max(high, cells[n])
        c += 1
        if number == 1:
            n = gathered[0]
            points[found, 0], points[found, 1] = moved[n, 0], moved[n, 1]
            points[found, 2] = moved[n, 2]
            found += 1
            continue
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
    first[len(held)] = found
    return points[:found]


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
