"""How far the points of a cloud are apart, and how much thinner a large one may be."""

import numpy as np
import small_gicp
from scipy.spatial import cKDTree

from executive.arrays import Float

_ASKED = 500  # points whose neighbours are looked for
# Points that are moved: each fit and the check cost as much as these. The noise of so many lets a
# motion vary by a hundredth of their own; a stone has a tenth of them.
_MOST = 10_000


def spacing_m(tree: cKDTree, neighbours: int) -> float:
    """Return the edge of the square that each point of a surface has to itself, its median [m].

    A point has as many neighbours as it asks for in a disc; each takes an equal part of its area.
    """
    asked = tree.data[:: max(tree.n // _ASKED, 1)]
    count = min(neighbours, tree.n - 1)
    if count < 1:
        return 0.0
    radii_m = tree.query(asked, k=[count + 1])[0]
    return float(np.median(radii_m) * np.sqrt(np.pi / count))


def grid_for(points: Float, least_m: float) -> float:
    """Return the grid's edge to which points are thinned [m], coarser where they are too many."""
    count = small_gicp.voxelgrid_sampling(points, least_m, 1).size()
    return least_m * max(1.0, float(np.sqrt(count / _MOST)))
