"""The first of many points that are apart from one another."""

import numpy as np
from numba import njit, types

from executive.arrays import Float, Int

_POINTS = types.Array(types.float64, 2, "C")


@njit(types.int64[::1](_POINTS, types.int64, types.float64), cache=True)  # type: ignore[untyped-decorator]
def spread(points: Float, most: int, apart_m: float) -> Int:
    """Return the numbers of the first points, each of which is apart from those before it.

    Args:
        points: In order of preference, shape (N, D) [m].
        most: Number of points that is enough.
        apart_m: Distance that is apart [m].
    """
    chosen, count = np.empty(most, dtype=np.int64), 0
    for n in range(len(points)):
        if count == most:
            break
        is_far = True
        for k in range(count):
            square = 0.0
            for axis in range(points.shape[1]):
                square += (points[n, axis] - points[chosen[k], axis]) ** 2
            if square <= apart_m * apart_m:
                is_far = False
                break
        if is_far:
            chosen[count] = n
            count += 1
    return chosen[:count]
