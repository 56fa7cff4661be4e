"""How hollow a part is: stones are nearly convex, and what is laid together of several is not."""

from functools import lru_cache

import numpy as np
from executive_plugins.segmentation.shape import principal_extents
from scipy.spatial import ConvexHull, QhullError, cKDTree

from executive.arrays import Float

_SHARE = 95  # percentile of the depths: the deepest points are those of the noise
_HULL = 2000  # points that the hull is laid about
_NEIGHBOURS = 5  # by whose distance points in the air are told from those of a surface
_STRAY = 2.0  # of the median distance: points farther off, as of reflections, would widen the hull
_ASKED = 500  # points whose depth is taken


def hollow_share(points: Float) -> float:
    """Return how deep the points lie under their convex hull, as a share of their longest side.

    The depth is that which one point in twenty exceeds. A part of points on one plane is not
    hollow.

    Args:
        points: Of the surface of one part [m], shape (N, 3).
    """
    some = np.ascontiguousarray(points[:: max(len(points) // _HULL, 1)], dtype=np.float64)
    longest_m = float(principal_extents(points)[0])
    return _depth_m(some.tobytes()) / max(longest_m, 1e-9)


@lru_cache(maxsize=64)  # a part is asked about twice: where it is split, and where it is judged
def _depth_m(surface: bytes) -> float:
    """Return the depth under the hull that one point in twenty exceeds [m], of rows of x, y, z."""
    some = np.frombuffer(surface).reshape(-1, 3)
    if len(some) > _NEIGHBOURS:
        tree = cKDTree(some, compact_nodes=False, balanced_tree=False)  # asked once: built fast
        apart_m = tree.query(some, k=_NEIGHBOURS + 1)[0][:, -1]
        some = some[apart_m <= _STRAY * np.median(apart_m)]
    try:
        planes = ConvexHull(some - some[0]).equations
    except QhullError:
        return 0.0
    asked = some[:: max(len(some) // _ASKED, 1)] - some[0]
    depths = -(asked @ planes[:, :3].T + planes[:, 3]).max(axis=1)
    return float(np.percentile(depths, _SHARE))
