"""One convex body or two: the plane that parts the patches of a surface into two bodies, so that
they lie as little as possible under the hulls of their own.

Two convex bodies that do not cut each other always have a plane between them, also where they
touch and where their hollow is shallow. Planes as cuts: Schoeler et al. 2015, "Constrained planar
cuts"; here they are judged by both hulls and not by the angles at the seam.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from executive.arrays import Bool, Float

Single = NDArray[np.float32]  # half the memory of float64, twice as fast
_NEIGHBOURS = 12  # patches that a normal is fitted to: itself and those about it
_NORMALS = 64  # axes along normals, as different from each other as possible
_AXES = 20  # axes to all sides, for edges
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
    near = patches[cKDTree(patches).query(patches, k=min(_NEIGHBOURS, len(patches)))[1]]
    near = near - near.mean(axis=1, keepdims=True)
    normals = np.linalg.eigh(np.einsum("nki,nkj->nij", near, near))[1][:, :, 0]
    return np.vstack([_different(np.ascontiguousarray(normals), _NORMALS), half_sphere(_AXES)])


def depths_under_hulls(patches: Float, axes: Float, is_beyond: Bool) -> Float:
    """Return how deep each patch lies under the hull of the patches on its own side of a cut [m],
    shape (N,).

    Args:
        patches: [m], shape (N, 3).
        axes: Unit vectors along which hulls are measured, shape (K, 3).
        is_beyond: Which patches are beyond the cut, shape (N,).
    """
    along = (patches - patches.mean(axis=0)) @ axes.T
    found = np.empty(len(patches))
    for side in (is_beyond, ~is_beyond):
        if side.any():
            its = along[side]
            found[side] = np.minimum(its.max(axis=0) - its, its - its.min(axis=0)).min(axis=1)
    return found


def best_cut(patches: Float, axes: Float, rng: np.random.Generator) -> Bool:
    """Return which patches are beyond the plane between two bodies, shape (N,).

    Args:
        patches: [m], shape (N, 3).
        axes: Unit vectors along which hulls are measured, shape (K, 3).
        rng: The only source of chance.
    """
    centre = patches.mean(axis=0)
    level = patches[:: max(len(patches) // _ASKED, 1)] - centre
    along = np.ascontiguousarray((level @ axes.T).astype(np.float32))
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


def _first_planes(level: Float) -> Float:
    """Return planes (n, d) with n·p = d in all directions, shape (M, 4)."""
    ways = half_sphere(_WAYS)
    ends = np.quantile(level @ ways.T, [_OUTERMOST, 1 - _OUTERMOST], axis=0)
    places = np.linspace(ends[0], ends[1], _CUTS).T
    return np.column_stack([np.repeat(ways, _CUTS, axis=0), places.reshape(-1)])


def _judged(level: Float, along: Single, planes: Float) -> Float:
    sides = np.ascontiguousarray(planes[:, :3] @ level.T > planes[:, 3:])
    share = sides.mean(axis=1)
    is_cut = np.minimum(share, 1 - share) >= 0.9 * _OUTERMOST
    return np.where(is_cut, _depths(along, sides.view(np.uint8)), np.inf)


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
def _depths(along: Single, sides: NDArray[np.uint8]) -> Float:
    """Return the mean depth of patches under the hulls of their sides, shape (M,)."""
    patches, axes = along.shape
    found = np.empty(len(sides))
    high, low = np.empty((2, axes), dtype=np.float32), np.empty((2, axes), dtype=np.float32)
    for k in range(len(sides)):
        high[:], low[:] = -np.inf, np.inf
        for i in range(patches):
            top, bottom = high[sides[k, i]], low[sides[k, i]]
            for a in range(axes):
                value = along[i, a]
                top[a] = value if value > top[a] else top[a]
                bottom[a] = value if value < bottom[a] else bottom[a]
        total = 0.0
        for i in range(patches):
            top, bottom = high[sides[k, i]], low[sides[k, i]]
            depth = np.float32(np.inf)
            for a in range(axes):
                value = along[i, a]
                up, down = top[a] - value, value - bottom[a]
                up = up if up < down else down
                depth = up if up < depth else depth
            total += float(depth)
        found[k] = total / patches
    return found
