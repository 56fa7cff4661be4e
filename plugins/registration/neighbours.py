"""Neighbours of points within a radius, in one table.

The neighbours of query i are `rows[starts[i] : starts[i + 1]]`.
"""

import numpy as np
from numba import njit

from executive.arrays import Float, Int


@njit(cache=True)  # type: ignore[untyped-decorator]
def neighbours_within(points: Float, queries: Float, radius_m: float) -> tuple[Int, Int]:
    """Find all points within a radius of each query, in an order that only the points determine.

    Args:
        points: Points of one segment [m], shape (N, 3), N ≥ 1. Memory grows with the volume of
            their bounding box.
        queries: Positions within that box [m], shape (M, 3).
        radius_m: The radius, itself included.

    Returns:
        Starts, shape (M + 1,), and rows of points.
    """
    low = np.array([points[:, 0].min(), points[:, 1].min(), points[:, 2].min()])
    high = np.array([points[:, 0].max(), points[:, 1].max(), points[:, 2].max()])
    spans = ((high - low) / radius_m).astype(np.int64) + 1
    order, firsts = _by_cell(points, low, spans, radius_m)
    even = points[order]  # in the order in which they are read
    starts = np.zeros(len(queries) + 1, dtype=np.int64)
    rows = np.empty(16 * len(queries) + len(points), dtype=np.int64)
    found = 0
    for i in range(len(queries)):
        x, y, z = queries[i]
        cx, cy, cz = (
            int((x - low[0]) / radius_m),
            int((y - low[1]) / radius_m),
            int((z - low[2]) / radius_m),
        )
        for ix in range(max(cx - 1, 0), min(cx + 2, spans[0])):
            for iy in range(max(cy - 1, 0), min(cy + 2, spans[1])):
                column = (ix * spans[1] + iy) * spans[2]
                first, last = (
                    firsts[column + max(cz - 1, 0)],
                    firsts[column + min(cz + 2, spans[2])],
                )
                if found + last - first > len(rows):
                    rows = np.concatenate(
                        (rows, np.empty(len(rows) + last - first, dtype=np.int64))
                    )
                for k in range(first, last):
                    dx, dy, dz = even[k, 0] - x, even[k, 1] - y, even[k, 2] - z
                    if dx * dx + dy * dy + dz * dz <= radius_m * radius_m:
                        rows[found] = order[k]
                        found += 1
        starts[i + 1] = found
    return starts, rows[:found]


@njit(cache=True)  # type: ignore[untyped-decorator]
def nearer(points: Float, starts: Int, rows: Int, radius_m: float) -> tuple[Int, Int]:
    """Return those neighbours of each point that are within a smaller radius, in their order."""
    fewer, kept = np.zeros(len(points) + 1, dtype=np.int64), np.empty(len(rows), dtype=np.int64)
    found = 0
    for i in range(len(points)):
        for k in range(starts[i], starts[i + 1]):
            dx = points[rows[k], 0] - points[i, 0]
            dy = points[rows[k], 1] - points[i, 1]
            dz = points[rows[k], 2] - points[i, 2]
            if dx * dx + dy * dy + dz * dz <= radius_m * radius_m:
                kept[found] = rows[k]
                found += 1
        fewer[i + 1] = found
    return fewer, kept[:found]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _by_cell(points: Float, low: Float, spans: Int, cell_m: float) -> tuple[Int, Int]:
    """Sort points by cell (x, then y, then z): their order, and where each cell begins in it."""
    cells = np.empty(len(points), dtype=np.int64)
    firsts = np.zeros(spans[0] * spans[1] * spans[2] + 1, dtype=np.int64)
    for i in range(len(points)):
        x, y, z = points[i] - low
        cells[i] = (int(x / cell_m) * spans[1] + int(y / cell_m)) * spans[2] + int(z / cell_m)
        firsts[cells[i] + 1] += 1
    firsts = np.cumsum(firsts)
    order, filled = np.empty(len(points), dtype=np.int64), firsts.copy()
    for i in range(len(points)):
        order[filled[cells[i]]] = i
        filled[cells[i]] += 1
    return order, firsts
