"""How much thinner a large cloud may be."""

import numpy as np
import small_gicp

from executive.arrays import Float

# Points that are moved: each fit and the check cost as much as these. The noise of so many lets a
# motion vary by a hundredth of their own; a stone has a tenth of them.
MOST = 10_000


def grid_for(points: Float, least_m: float) -> float:
    """Return the grid's edge to which points are thinned [m], coarser where they are too many."""
    count = small_gicp.voxelgrid_sampling(points, least_m, 1).size()
    return least_m * max(1.0, float(np.sqrt(count / MOST)))
