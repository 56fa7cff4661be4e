"""How far the points of a cloud are apart, which limits what can be seen in it."""

import numpy as np
from numba import njit

from executive.arrays import Float

_ASKED = 32  # points whose neighbours are looked for


def spacing_m(points: Float) -> float:
    """Return the lower quartile of distances to the fourth neighbour [m], shape (N, 3).

    On a surface with points on a square grid it is the grid's edge. Up to half of the points may be
    in the air, as reflections are, which have no neighbours near. 0 for too few points.
    """
    if len(points) <= 4:
        return 0.0
    asked = points[:: max(len(points) // _ASKED, 1)]
    return float(np.quantile(_fourth(np.ascontiguousarray(asked), points), 0.25))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _fourth(asked: Float, points: Float) -> Float:
    """Return the distance from each point asked about to its fourth neighbour, shape (M,)."""
    found = np.empty(len(asked))
    for k in range(len(asked)):
        best = np.full(5, np.inf)  # the point itself is the first
        for i in range(len(points)):
            square = (points[i, 0] - asked[k, 0]) ** 2
            if square >= best[4]:  # as of nearly all points
                continue
            square += (points[i, 1] - asked[k, 1]) ** 2
            square += (points[i, 2] - asked[k, 2]) ** 2
            if square < best[4]:
                best[4] = square
                best.sort()
        found[k] = np.sqrt(best[4])
    return found
