"""One point of each square of a wide site, so that what is scanned densely weighs no more."""

import numpy as np
from numba import njit

from executive.arrays import Float


@njit(cache=True)  # type: ignore[untyped-decorator]
def first_in_squares(points: Float, square_m: float) -> Float:
    """Return the first point in each square of a grid, seen from above, in their order.

    Args:
        points: [m], shape (N, 3), N ≥ 1.
        square_m: Edge of a square [m]; memory grows with their number, a byte each.

    Returns:
        At most a point a square [m], shape (M, 3).
    """
    low_x, low_y = points[:, 0].min(), points[:, 1].min()
    wide = int((points[:, 0].max() - low_x) / square_m) + 1
    deep = int((points[:, 1].max() - low_y) / square_m) + 1
    is_taken = np.zeros((wide, deep), dtype=np.bool_)
    rows, count = np.empty(min(len(points), wide * deep), dtype=np.int64), 0
    for n in range(len(points)):
        i, j = int((points[n, 0] - low_x) / square_m), int((points[n, 1] - low_y) / square_m)
        if not is_taken[i, j]:
            is_taken[i, j], rows[count] = True, n
            count += 1
    return points[rows[:count]]
