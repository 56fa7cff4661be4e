"""One convex body or two: the plane that parts the patches of a surface into two bodies, so that
they lie as little as possible under the hulls of their own.

Two convex bodies that do not cut each other always have a plane between them, also where they
touch and where their hollow is shallow. Planes as cuts: Schoeler et al. 2015, "Constrained planar
cuts"; here they are judged by both hulls and not by the angles at the seam.
"""

import numpy as np
import small_gicp
from executive_plugins.segmentation.shape import quantile
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Bool, Float

Single = NDArray[np.float32]  # half the memory of float64, twice as fast
Narrow = NDArray[np.int32]
_NEIGHBOURS = 12  # patches that a normal is fitted to: itself and those about it
_NORMALS = 64  # axes along normals, as different from each other as possible
_AXES = 20  # axes to all sides
_MOST = np.iinfo(np.int32).max
_ASKED = 120  # patches by which cuts are judged
_WAYS = 24  # directions of the first cuts
_CUTS = 7  # places of the first cuts along each direction
_OUTERMOST = 0.08  # share of the patches beyond the outermost cut: less of a stone is none
_BEST = 4  # cuts that are moved
_MOVED = 12  # cuts beside each of these, in each of two rounds
_TURNS_RAD = (0.15, 0.075)  # deviations of these rounds: half and a quarter of what is between ways
_SHIFTS = (0.05, 0.025)  # deviations of these rounds, in the longest side


def axes_of(patches: Float) -> Float:
    """Return the axes along which hulls are measured: normals of the surface, and to all sides,
    shape (K, 3).
    """
    cloud = small_gicp.PointCloud(patches)
    small_gicp.estimate_normals(cloud, num_neighbors=_NEIGHBOURS)
    normals = np.array(cloud.normals()[:, :3], order="C")
    return np.vstack([_different(normals, _NORMALS), _EDGE_AXES])


def depths_under_hulls(patches: Float, axes: Float, is_beyond: Bool) -> Float:
    """Return how deep each patch lies under the hull of the patches on its own side of a cut [m],
    shape (N,).

    Args:
        patches: [m], shape (N, 3).
        axes: Unit vectors along which hulls are measured, shape (K, 3).
        is_beyond: Which patches are beyond the cut, shape (N,).
    """
    along = (patches - patches.mean(axis=0)) @ axes.T
    return np.asarray(_least_depths(along, is_beyond))


def best_cut(patches: Float, axes: Float, rng: np.random.Generator) -> Bool:
    """Return which patches are beyond the plane between two bodies, shape (N,).

    Args:
        patches: [m], shape (N, 3).
        axes: Unit vectors along which hulls are measured, shape (K, 3).
        rng: The only source of chance.
    """
    centre = patches.mean(axis=0)
    level = patches[:: max(len(patches) // _ASKED, 1)] - centre
    # Patches deep under the hull of all come first: most cuts leave them deep, and are given up.
    level = level[np.argsort(-depths_under_hulls(level, axes, np.zeros(len(level), dtype=bool)))]
    along = (level @ axes.T).astype(np.float32)
    along = np.ascontiguousarray(along - along.min(axis=0))
    longest_m = float(np.ptp(level, axis=0).max())
    planes = _first_planes(level)
    depths = _judged(level, along, planes)
    for turn_rad, shift in zip(_TURNS_RAD, _SHIFTS, strict=True):
        best = planes[np.argsort(depths, kind="stable")[:_BEST]]
        moved = np.repeat(best, _MOVED, axis=0)
        moved[:, :3] += rng.normal(0, turn_rad, (len(moved), 3))
        moved[:, :3] /= np.linalg.norm(moved[:, :3], axis=1)[:, None]
        moved[:, 3] += rng.normal(0, shift * longest_m, len(moved))
        planes = np.vstack([best, moved])
        depths = _judged(level, along, planes)
    plane = planes[int(np.argmin(depths))]
    return np.asarray((patches - centre) @ plane[:3] > plane[3])


def half_sphere(count: int) -> Float:
    """Return axes spread evenly over all directions, shape (count, 3)."""
    i = np.arange(count) + 0.5
    z = i / count
    turn = np.pi * (1 + 5**0.5) * i
    wide = np.sqrt(1 - z**2)
    return np.column_stack([wide * np.cos(turn), wide * np.sin(turn), z])


_EDGE_AXES = half_sphere(_AXES)  # axes to all sides, for edges, shape (20, 3)
_FIRST_WAYS = half_sphere(_WAYS)


def _first_planes(level: Float) -> Float:
    """Return planes (n, d) with n·p = d in all directions, shape (M, 4)."""
    along = level @ _FIRST_WAYS.T
    first, last = (quantile(along, share) for share in (_OUTERMOST, 1 - _OUTERMOST))
    places = np.linspace(first, last, _CUTS).T
    return np.column_stack([np.repeat(_FIRST_WAYS, _CUTS, axis=0), places.reshape(-1)])


def _judged(level: Float, along: Single, planes: Float) -> Float:
    """Return the mean depth under two hulls that each plane leaves [m], shape (M,); inf for planes
    that cut off little, and for those that are not among the best.
    """
    sides = np.ascontiguousarray(planes[:, :3] @ level.T > planes[:, 3:])
    share = sides.mean(axis=1)
    is_cut = np.minimum(share, 1 - share) >= 0.9 * _OUTERMOST
    depths = np.full(len(planes), np.inf)
    cuts = sides[is_cut].view(np.uint8)
    ends = _ends(along.view(np.int32), cuts).view(np.float32)
    depths[is_cut] = _depths(along, ends, cuts, _BEST)
    return depths


@njit(cache=True)  # type: ignore[untyped-decorator]
def _least_depths(along: Float, is_beyond: Bool) -> Float:
    """Return how deep each patch lies between the ends of its own side, the least of all axes [m].

    Args:
        along: Places of the patches along the axes [m], shape (N, K).
        is_beyond: Which patches are beyond the cut, shape (N,).
    """
    patches, axes = along.shape
    tops, bottoms = np.full((2, axes), -np.inf), np.full((2, axes), np.inf)
    for i in range(patches):
        here, top, bottom = along[i], tops[int(is_beyond[i])], bottoms[int(is_beyond[i])]
        for a in range(axes):
            top[a] = here[a] if here[a] > top[a] else top[a]
            bottom[a] = here[a] if here[a] < bottom[a] else bottom[a]
    found, depths = np.empty(patches), np.empty(axes)
    bits = depths.view(np.int64)  # in the same order, as depths are not negative; see `_ends`
    for i in range(patches):
        here, top, bottom = along[i], tops[int(is_beyond[i])], bottoms[int(is_beyond[i])]
        for a in range(axes):
            up, down = top[a] - here[a], here[a] - bottom[a]
            depths[a] = up if up < down else down
        smallest = bits[0]
        for a in range(axes):
            smallest = min(smallest, bits[a])
        bits[0] = smallest
        found[i] = depths[0]
    return found


@njit(cache=True)  # type: ignore[untyped-decorator]
def _different(normals: Float, count: int) -> Float:
    """Return rows that differ most, whatever their sign, at most so many."""
    count = min(count, len(normals))
    kept = np.empty((count, 3))
    nearest = np.zeros(len(normals))
    row = 0
    for k in range(count):
        kept[k] = normals[row]
        worst = 2.0
        for i in range(len(normals)):
            c = abs(
                normals[i, 0] * kept[k, 0] + normals[i, 1] * kept[k, 1] + normals[i, 2] * kept[k, 2]
            )
            nearest[i] = max(nearest[i], c)
            if nearest[i] < worst:
                worst, row = nearest[i], i
    return kept


@njit(cache=True)  # type: ignore[untyped-decorator]
def _ends(places: Narrow, sides: NDArray[np.uint8]) -> Narrow:
    """Return the highest places of both sides of each cut along the axes, then the lowest of both,
    shape (M, 4, K).

    Places are the bits of numbers that are not negative, which have the same order: compilers take
    the largest of several whole numbers at once, not of several fractions. Four patches are looked
    at before an end is written.
    """
    ends = np.empty((len(sides), 4, places.shape[1]), dtype=np.int32)
    rows = np.empty(len(places) + 3, dtype=np.int64)
    for k in range(len(sides)):
        for side in range(2):
            tops, bottoms, count = ends[k, side], ends[k, 2 + side], 0
            tops[:], bottoms[:] = 0, _MOST
            for i in range(len(places)):
                rows[count] = i
                count += sides[k, i] == side
            rows[count : count + 3] = rows[max(count - 1, 0)]  # the last once more, for a full four
            for i in range(0, count, 4):
                p, q = places[rows[i]], places[rows[i + 1]]
                r, s = places[rows[i + 2]], places[rows[i + 3]]
                for a in range(places.shape[1]):
                    tops[a] = max(tops[a], max(max(p[a], q[a]), max(r[a], s[a])))
                for a in range(places.shape[1]):
                    bottoms[a] = min(bottoms[a], min(min(p[a], q[a]), min(r[a], s[a])))
    return ends


@njit(cache=True)  # type: ignore[untyped-decorator]
def _depths(along: Single, ends: Single, sides: NDArray[np.uint8], kept: int) -> Float:
    """Return the mean depth of patches under the hulls of their sides, shape (M,); inf for cuts
    that are known not to be among the best.

    Args:
        along: Places of the patches along the axes [m], shape (N, K).
        ends: What `_ends` returned [m], shape (M, 4, K).
        sides: On which side of each cut the patches are, 0 or 1, shape (M, N).
        kept: How many of the best cuts are asked for.
    """
    patches, axes = along.shape
    found, least = np.full(len(sides), np.inf), np.full(kept, np.inf)
    depths = np.empty(axes, dtype=np.float32)
    bits = depths.view(np.int32)
    for k in range(len(sides)):
        total, most = 0.0, least[-1] * patches
        for i in range(patches):
            here, top, bottom = along[i], ends[k, sides[k, i]], ends[k, 2 + sides[k, i]]
            for a in range(axes):
                up, down = top[a] - here[a], here[a] - bottom[a]
                depths[a] = up if up < down else down
            smallest = bits[0]
            for a in range(axes):
                smallest = min(smallest, bits[a])
            bits[0] = smallest
            total += depths[0]
            if total > most:
                break
        if total > most:
            continue
        found[k] = total / patches
        place = kept - 1
        while place > 0 and least[place - 1] > found[k]:
            least[place] = least[place - 1]
            place -= 1
        least[place] = min(least[place], found[k])
    return found
