"""The feet of objects: points that are too low to be told from the ground by height alone."""

from collections.abc import Sequence

import numpy as np
from numba import njit
from scipy.spatial import cKDTree

from executive.arrays import Bool, Float, Int, read_only

_CELLS = 1_000  # of the grid in which points are looked up, along either side of the site


def feet_of(parts: Sequence[Float], low: Float, reach_m: float) -> list[Float]:
    """Return the foot of each object.

    Args:
        parts: Points of each object above its foot [m], shapes (N, 3).
        low: Points a little above the ground [m], shape (L, 3).
        reach_m: Largest distance of a foot's point from the points of its object [m].

    Returns:
        For each object the points of `low` that are within reach of it, and nearer to it than to
        any other [m], shapes (F, 3).
    """
    none = np.zeros((0, 3))
    if not len(low) or not reach_m:
        return [none] * len(parts)
    highest_m = low[:, 2].max() + reach_m
    near = [part[part[:, 2] <= highest_m] for part in parts]
    if not any(len(part) for part in near):
        return [none] * len(parts)
    owner = np.repeat(np.arange(len(near)), [len(part) for part in near])
    tree = cKDTree(np.concatenate(near))
    distance_m, nearest = tree.query(low, distance_upper_bound=reach_m)
    found = np.flatnonzero(np.isfinite(distance_m))
    of = owner[nearest[found]]
    in_turn = np.argsort(of, kind="stable")
    ends = np.cumsum(np.bincount(of, minlength=len(parts)))
    return np.split(low.take(found.take(in_turn), axis=0), ends[:-1])


def rows_beside(
    points: Float,
    above: Float,
    heights_m: tuple[float, float],
    parts: Sequence[Float],
    reach_m: float,
) -> Int:
    """Return the rows of points between two heights that may be within reach of an object, (L,).

    On a wide site half of the ground is between these heights: they are not copied for that.

    Args:
        points: All of the cloud [m], shape (N, 3).
        above: Their heights above the ground [m], shape (N,).
        heights_m: The lower height, above which points count, and the upper one, up to which [m].
        parts: Points of each object in the cloud's frame [m], shapes (N, 3).
        reach_m: Largest distance from the points of an object [m].
    """
    if not parts or not reach_m:
        return np.empty(0, dtype=np.int64)
    corners = np.array([_corners(read_only(part)) for part in parts])
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    cell_m = max(reach_m, float((high - low).max()) / _CELLS)
    spans = np.floor((high - low) / cell_m).astype(np.int64) + 3  # with a rim of a cell
    is_in = np.zeros(spans, dtype=np.bool_)
    for part in parts:
        _mark(read_only(part), low, cell_m, is_in)
    is_beside = np.zeros(spans, dtype=np.bool_)
    i, j = np.nonzero(is_in)
    for di, dj in np.ndindex(3, 3):
        is_beside[i + di - 1, j + dj - 1] = True
    return np.asarray(
        _rows(read_only(points), read_only(above), *heights_m, low, cell_m, is_beside)
    )


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _corners(points: Float) -> Float:  # pragma: no cover - compiled
    """Return the lowest and the highest x and y [m], shape (2, 2)."""
    corners = np.empty((2, 2))
    corners[0], corners[1] = np.inf, -np.inf
    for n in range(len(points)):
        for axis in range(2):
            corners[0, axis] = min(corners[0, axis], points[n, axis])
            corners[1, axis] = max(corners[1, axis], points[n, axis])
    return corners


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _mark(
    points: Float, low: Float, cell_m: float, is_in: Bool
) -> None:  # pragma: no cover - compiled
    """Mark the cells of a grid with a rim of one cell in which points are."""
    for n in range(len(points)):
        i = int(np.floor((points[n, 0] - low[0]) / cell_m)) + 1
        j = int(np.floor((points[n, 1] - low[1]) / cell_m)) + 1
        is_in[i, j] = True


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _rows(
    points: Float,
    above: Float,
    least_m: float,
    most_m: float,
    low: Float,
    cell_m: float,
    is_beside: Bool,
) -> Int:  # pragma: no cover - compiled
    rows, found = np.empty(1024, dtype=np.int64), 0
    for n in range(len(points)):
        if not (above[n] > least_m and not above[n] > most_m):
            continue
        i = int(np.floor((points[n, 0] - low[0]) / cell_m)) + 1
        j = int(np.floor((points[n, 1] - low[1]) / cell_m)) + 1
        if 0 <= i < is_beside.shape[0] and 0 <= j < is_beside.shape[1] and is_beside[i, j]:
            if found == len(rows):
                rows = np.append(rows, rows)
            rows[found] = n
            found += 1
    return rows[:found]
