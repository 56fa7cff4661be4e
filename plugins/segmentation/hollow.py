"""How hollow a part is: stones are nearly convex, and what is laid together of several is not."""

from functools import lru_cache

import numpy as np
from executive_plugins.segmentation.shape import principal_extents, quantile
from numba import njit
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from executive.arrays import Float
from executive.geometry.point_grid import PointGrid

Single = NDArray[np.float32]
_SHARE = 0.95  # quantile of the depths: the deepest points are those of the noise
_HULL = 2000  # points that the hull is laid about
_NEIGHBOURS = 5  # by whose distance points in the air are told from those of a surface
_CELL = 2.0  # edge of the cells in which neighbours are looked up, in their distance: the fastest
_STRAY = 2.0  # of the median distance: points farther off, as of reflections, would widen the hull
_ASKED = 500  # points whose depth is taken
_FEW = 0.5 * (1 - _SHARE)  # at least half of the points are no strays
_SLABS = 64  # three of four parts with half the hollows of one stone need no hull then
_HEIGHTS = (np.arange(_SLABS) + 0.5) / _SLABS  # of directions that are even over a hemisphere
_TURNS = np.pi * (1 + np.sqrt(5)) * np.arange(_SLABS)  # by the golden angle
_DIRECTIONS = np.column_stack(
    [
        np.sqrt(1 - _HEIGHTS**2) * np.cos(_TURNS),
        np.sqrt(1 - _HEIGHTS**2) * np.sin(_TURNS),
        _HEIGHTS,
    ]
).astype(np.float32)  # a micrometre is enough, in half the time


def is_hollow(points: Float, most: float, longest_m: float | None = None) -> bool:
    """Return whether `hollow_share` is above a limit; mostly without the hull.

    The longest side of the points [m] need not be given.

    The slabs between parallel planes about the points hold the hull, so that no point is deeper
    under the hull than in them. More than half of the points are no strays; so if one in forty of
    all is deep at most, one in twenty of the others is. Where more are, strays are left out first.
    """
    if longest_m is None:
        longest_m = float(principal_extents(points)[0])
    surface, deep_m = _surface(points), most * longest_m
    depths = _depths_in_slabs_m(surface)
    if np.count_nonzero(depths > deep_m) <= _FEW * len(depths):
        return False
    depths = _depths_in_slabs_m(_without_strays(surface))
    if quantile(depths.astype(np.float64), _SHARE) <= deep_m:
        return False
    return hollow_share(points) > most


def hollow_share(points: Float) -> float:
    """Return how deep the points lie under their convex hull, as a share of their longest side.

    The depth is that which one point in twenty exceeds. A part of points on one plane is not
    hollow.

    Args:
        points: Of the surface of one part [m], shape (N, 3).
    """
    longest_m = float(principal_extents(points)[0])
    return _depth_m(_without_strays(_surface(points))) / max(longest_m, 1e-9)


def _surface(points: Float) -> bytes:
    """Return the points that the hull is laid about, as rows of x, y, z [m]."""
    return np.asarray(points[:: max(len(points) // _HULL, 1)], dtype=np.float64).tobytes()


@lru_cache(maxsize=64)  # a part is asked about twice: where it is split, and where it is judged
def _depths_in_slabs_m(surface: bytes) -> Single:
    """Return how deep some points lie in the slabs about all [m], of rows of x, y, z."""
    some = np.frombuffer(surface).reshape(-1, 3)
    along = _DIRECTIONS @ np.ascontiguousarray((some - some[0]).T, dtype=np.float32)
    lowest, highest = along.min(axis=1), along.max(axis=1)
    return np.asarray(_least_depths(along, lowest, highest, max(len(some) // _ASKED, 1)))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _least_depths(along: Single, lowest: Single, highest: Single, every: int) -> Single:
    """Return the least depth of every n-th point in slabs, of places (K, N) and ends (K,) [m]."""
    found = np.full(-(-along.shape[1] // every), np.inf, dtype=np.float32)
    for a in range(len(along)):
        for i in range(len(found)):
            here = along[a, i * every]
            up, down = highest[a] - here, here - lowest[a]
            depth = up if up < down else down
            found[i] = depth if depth < found[i] else found[i]
    return found


@lru_cache(maxsize=64)
def _without_strays(surface: bytes) -> bytes:
    """Return the points that have others as near as most have, of rows of x, y, z [m]."""
    some = np.frombuffer(surface).reshape(-1, 3)
    if len(some) <= _NEIGHBOURS:
        return surface
    sides_m = np.sort(np.ptp(some, axis=0))
    even_m = float(np.sqrt(2 * sides_m[1] * sides_m[2] / len(some)))  # as on a flat box
    grid = PointGrid(some, max(_CELL * even_m, 1e-6))
    apart_m = grid.distances_m(some, _NEIGHBOURS + 1)[:, -1]
    return some[apart_m <= _STRAY * np.median(apart_m)].tobytes()


@lru_cache(maxsize=64)
def _depth_m(surface: bytes) -> float:
    """Return the depth under the hull that one point in twenty exceeds [m], of rows of x, y, z."""
    some = np.frombuffer(surface).reshape(-1, 3)
    try:
        planes = ConvexHull(some - some[0]).equations
    except QhullError:
        return 0.0
    asked = some[:: max(len(some) // _ASKED, 1)] - some[0]
    depths = -(asked @ planes[:, :3].T + planes[:, 3]).max(axis=1)
    return float(quantile(depths, _SHARE))
