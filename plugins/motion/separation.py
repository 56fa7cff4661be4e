"""Pairs of convex bodies that are shown to keep a distance, without a distance being computed."""

import math

import numpy as np
from numba import njit

from executive.arrays import Float, Int

_TRIES = 12  # directions per pair; a pair that none of them separates is looked at by FCL
_SAFETY_M = 1e-6  # by which a gap must exceed the clearance, far above rounding


def compile_separation() -> None:
    """Compile the loop, which takes a second on the first run after an installation."""
    starts, pairs = np.array([0, 1, 2]), np.array([[1, 0]])
    unseparated(np.eye(4)[None, None], np.zeros(2, int), np.zeros((2, 3)), starts, pairs, 0.0)


def unseparated(
    frames: Float, owners: Int, corners: Float, starts: Int, pairs: Int, clearance_m: float
) -> Int:
    """Return the postures and pairs that no plane shows to be far enough apart, shape (M, 2).

    They are in the order of the postures, and of the pairs in each. Two convex bodies whose corners
    lie on either side of a slab are at least as far apart as the slab is thick. The directions that
    are tried are that of the posture before, that of the centres, and those of Frank and Wolfe's
    method for the nearest points.

    Args:
        frames: Poses of the links in the base, shape (L, K, 4, 4).
        owners: Link of each body, shape (B,).
        corners: Corners of all bodies in their links [m], shape (C, 3).
        starts: First corner of each body, and the number of all, shape (B + 1,).
        pairs: Bodies of each pair, shape (P, 2).
        clearance_m: Distance that is to be kept.
    """
    return np.asarray(
        _unseparated(
            np.ascontiguousarray(frames), owners, corners, starts, pairs, clearance_m + _SAFETY_M
        )
    )


@njit(cache=True)  # type: ignore[untyped-decorator]
def _unseparated(
    frames: Float, owners: Int, corners: Float, starts: Int, pairs: Int, clearance_m: float
) -> Int:
    found = np.empty((frames.shape[1] * len(pairs), 2), dtype=np.int64)
    count, centres = 0, np.zeros((len(owners), 3))
    radii, placed = np.zeros(len(owners)), np.empty_like(corners)
    for b in range(len(owners)):
        own = corners[starts[b] : starts[b + 1]]
        for axis in range(3):
            centres[b, axis] = 0.5 * (own[:, axis].min() + own[:, axis].max())
        for corner in own:
            radii[b] = max(radii[b], math.sqrt(((corner - centres[b]) ** 2).sum()))
    last, middle = np.zeros((len(pairs), 3)), np.empty((len(owners), 3))
    for k in range(frames.shape[1]):
        for b in range(len(owners)):
            T = frames[owners[b], k]
            _place(T, centres[b : b + 1], middle[b : b + 1])
            _place(T, corners[starts[b] : starts[b + 1]], placed[starts[b] : starts[b + 1]])
        for p in range(len(pairs)):
            i, j = pairs[p]
            way = middle[j] - middle[i]
            if math.sqrt((way**2).sum()) - radii[i] - radii[j] >= clearance_m:
                continue
            one, other = placed[starts[i] : starts[i + 1]], placed[starts[j] : starts[j + 1]]
            if not _are_apart(one, other, way, last[p], clearance_m):
                found[count] = k, p
                count += 1
    return found[:count]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _place(T: Float, points: Float, out: Float) -> None:
    for n in range(len(points)):
        for row in range(3):
            out[n, row] = (
                T[row, 0] * points[n, 0]
                + T[row, 1] * points[n, 1]
                + T[row, 2] * points[n, 2]
                + T[row, 3]
            )


@njit(cache=True)  # type: ignore[untyped-decorator]
def _are_apart(a: Float, b: Float, way: Float, last: Float, clearance_m: float) -> bool:
    """Return whether a direction separates two bodies; it is kept in `last` (3,) for the next."""
    nearest, far = np.empty(3), np.empty(3)
    if last.any() and _gap(a, b, last, far) >= clearance_m:
        return True
    nearest[:] = way
    for _ in range(_TRIES):
        length = math.sqrt((nearest**2).sum())
        if length < clearance_m:
            return False  # a point of the difference of the bodies is as near as that
        direction = nearest / length
        if _gap(a, b, direction, far) >= clearance_m:
            last[:] = direction
            return True
        step = far - nearest
        square = (step**2).sum()
        if square == 0.0:
            return False
        nearest += min(max(-(nearest * step).sum() / square, 0.0), 1.0) * step
    return False


@njit(cache=True)  # type: ignore[untyped-decorator]
def _gap(a: Float, b: Float, direction: Float, far: Float) -> float:
    """Return the thickness of the slab between two bodies across a unit direction from a to b.

    The difference of the two corners that touch it is written to `far`, shape (3,).
    """
    x, y, z = direction
    most, first, least, second = -np.inf, 0, np.inf, 0
    for n in range(len(a)):
        along = a[n, 0] * x + a[n, 1] * y + a[n, 2] * z
        if along > most:
            most, first = along, n
    for n in range(len(b)):
        along = b[n, 0] * x + b[n, 1] * y + b[n, 2] * z
        if along < least:
            least, second = along, n
    for row in range(3):
        far[row] = b[second, row] - a[first, row]
    return least - most
