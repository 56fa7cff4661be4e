"""How far the points of a cloud are apart, which limits what can be seen in it."""

import numpy as np
from executive_plugins.segmentation.shape import spans

from executive.arrays import Float
from executive.geometry.point_grid import PointGrid

_ASKED = 32  # points whose neighbours are looked for
_LEAST_CELL_M = 0.01  # of the grid in which they are looked for; its edge costs time alone


def spacing_m(points: Float) -> float:
    """Return the lower quartile of distances to the fourth neighbour [m], shape (N, 3).

    On a surface with points on a square grid it is the grid's edge. Up to half of the points may be
    in the air, as reflections are, which have no neighbours near. 0 for too few points.
    """
    if len(points) <= 4:
        return 0.0
    asked = points[:: max(len(points) // _ASKED, 1)]
    sides_m = spans(points)
    even_m = float(np.sqrt(sides_m[0] * sides_m[1] / len(points)))  # as if they were all about
    fourth_m = PointGrid(points, max(even_m, _LEAST_CELL_M)).distances_m(asked, 5)[:, 4]
    return float(np.quantile(fourth_m, 0.25))  # the first is the point itself
