"""Bodies over maps of heights: where they are below a map, in one compiled loop without copies."""

import math

import numpy as np
from numba import njit

from executive.arrays import Bool, Float, Int


def survey(
    T_base_links: Float,
    samples: Float,
    heights: Float,
    floor: Float,
    radius_m: float,
    cell_m: float,
) -> tuple[Bool, Float]:
    """Return where a body is below a map of heights, and how deep it is in the ground there.

    Args:
        T_base_links: Poses of the body's link, shape (K, 4, 4).
        samples: Points of the body's surface in its link [m], shape (S, 3).
        heights: Highest obstacles by cell [m], shape (n, n).
        floor: Heights of the ground by cell [m], shape (n, n).
        radius_m: Half the edge of the maps, whose middle is the base.
        cell_m: Edge of a cell.

    Returns:
        Whether any sample is below `heights`, shape (K,); and the largest depth of a sample below
        `floor` [m], shape (K,), −inf where none is below `heights`.
    """
    is_low, sunk_m = _survey(
        np.ascontiguousarray(T_base_links),
        np.ascontiguousarray(samples),
        heights,
        floor,
        radius_m,
        cell_m,
    )
    return np.asarray(is_low), np.asarray(sunk_m)


def close(
    T_base_links: Float,
    sphere: tuple[Float, float],
    highest: Float,
    radius_m: float,
    block_m: float,
) -> Int:
    """Return the poses in which a sphere reaches below the heights of its block, rising.

    Args:
        T_base_links: Poses of the sphere's link, shape (K, 4, 4).
        sphere: Its centre in the link and its radius [m].
        highest: Heights by block [m], shape (m, m).
        radius_m: Half the edge of the map, whose middle is the base.
        block_m: Edge of a block.
    """
    T, (centre, own_m) = np.ascontiguousarray(T_base_links), sphere
    return np.flatnonzero(_close(T, centre, own_m, highest, radius_m, block_m))


def compile_survey() -> None:
    """Compile the loops, which takes a second on the first run after an installation."""
    close(np.eye(4)[None], (np.zeros(3), 1.0), np.zeros((1, 1)), 1.0, 1.0)
    survey(np.eye(4)[None], np.zeros((1, 3)), np.zeros((1, 1)), np.zeros((1, 1)), 1.0, 1.0)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _survey(
    T: Float, samples: Float, heights: Float, floor: Float, radius_m: float, cell_m: float
) -> tuple[Bool, Float]:
    is_low, sunk_m = np.zeros(len(T), dtype=np.bool_), np.full(len(T), -np.inf)
    last = len(heights) - 1
    for k in range(len(T)):
        deepest = -np.inf
        for s in range(len(samples)):
            x, y, z = samples[s]
            at_x = T[k, 0, 0] * x + T[k, 0, 1] * y + T[k, 0, 2] * z + T[k, 0, 3]
            at_y = T[k, 1, 0] * x + T[k, 1, 1] * y + T[k, 1, 2] * z + T[k, 1, 3]
            at_z = T[k, 2, 0] * x + T[k, 2, 1] * y + T[k, 2, 2] * z + T[k, 2, 3]
            column = min(max(math.floor((at_x + radius_m) / cell_m), 0), last)
            row = min(max(math.floor((at_y + radius_m) / cell_m), 0), last)
            is_low[k] |= at_z < heights[column, row]
            deepest = max(deepest, floor[column, row] - at_z)
        if is_low[k]:
            sunk_m[k] = deepest
    return is_low, sunk_m


@njit(cache=True)  # type: ignore[untyped-decorator]
def _close(
    T: Float, centre: Float, own_m: float, highest: Float, radius_m: float, block_m: float
) -> Bool:
    is_close = np.zeros(len(T), dtype=np.bool_)
    last = len(highest) - 1
    x, y, z = centre
    for k in range(len(T)):
        at_x = T[k, 0, 0] * x + T[k, 0, 1] * y + T[k, 0, 2] * z + T[k, 0, 3]
        at_y = T[k, 1, 0] * x + T[k, 1, 1] * y + T[k, 1, 2] * z + T[k, 1, 3]
        at_z = T[k, 2, 0] * x + T[k, 2, 1] * y + T[k, 2, 2] * z + T[k, 2, 3]
        column = min(max(math.floor((at_x + radius_m) / block_m), 0), last)
        row = min(max(math.floor((at_y + radius_m) / block_m), 0), last)
        is_close[k] = at_z - own_m < highest[column, row]
    return is_close
