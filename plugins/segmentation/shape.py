"""Sizes and flatness of point sets; sums run in one order, so that the bits are the same on any
number of threads.
"""

import numpy as np
from numba import njit

from executive.arrays import Float, Int

_AXES = np.eye(3)


@njit(cache=True)  # type: ignore[untyped-decorator]
def moments(points: Float) -> tuple[Float, Float]:
    """Return the mean, shape (3,), and the scatter about it, shape (3, 3)."""
    x, y, z = 0.0, 0.0, 0.0
    for i in range(len(points)):
        x, y, z = x + points[i, 0], y + points[i, 1], z + points[i, 2]
    count = max(len(points), 1)
    mean = np.array([x / count, y / count, z / count])
    xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(points)):
        x, y, z = points[i, 0] - mean[0], points[i, 1] - mean[1], points[i, 2] - mean[2]
        xx, xy, xz = xx + x * x, xy + x * y, xz + x * z
        yy, yz, zz = yy + y * y, yz + y * z, zz + z * z
    return mean, np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def spans(points: Float) -> Float:
    """Return the extents along the axes of the frame [m], shape (3,)."""
    # An array as the default of a compiled function is another one in each process to numba's
    # cache: the function would be compiled in each run, and kept once more.
    return np.asarray(spans_along(points, _AXES))


@njit(cache=True)  # type: ignore[untyped-decorator]
def spans_along(points: Float, axes: Float) -> Float:
    """Return the extents along axes, given as columns [m], shape (3,)."""
    extents = np.zeros(3)
    if not len(points):
        return extents - np.inf
    for a in range(3):
        u, v, w = axes[0, a], axes[1, a], axes[2, a]
        low, high = np.inf, -np.inf
        for i in range(len(points)):
            along = points[i, 0] * u + points[i, 1] * v + points[i, 2] * w
            low, high = low if low < along else along, high if high > along else along
        extents[a] = high - low
    return extents


@njit(cache=True)  # type: ignore[untyped-decorator]
def principal_extents(points: Float) -> Float:
    """Return the side lengths of the box along the principal axes, longest first [m],
    shape (3,).
    """
    axes = np.linalg.eigh(moments(points)[1])[1]
    return np.sort(spans_along(points, axes))[::-1].copy()


def quantile(values: Float, share: float) -> Float:
    """Return the value below which a share of the values lies, along the first axis.

    It is that of `np.quantile`, whose checks take longer than the few values of a part.
    """
    ordered, place = np.sort(values, axis=0), (len(values) - 1) * share
    low, above = ordered[int(place)], ordered[min(int(place) + 1, len(values) - 1)]
    part = place - int(place)
    between = low + (above - low) * part if part < 0.5 else above - (above - low) * (1 - part)
    return np.asarray(between)


@njit(cache=True)  # type: ignore[untyped-decorator]
def planes_through(points: Float, triples: Int) -> Float:
    """Return planes (n, d) with n·p = d through triples of points, normals up, (3, M) → (at most M,
    4).
    """
    planes, count = np.empty((triples.shape[1], 4)), 0
    for k in range(triples.shape[1]):
        a, b, c = points[triples[0, k]], points[triples[1, k]], points[triples[2, k]]
        u, v, w = b[0] - a[0], b[1] - a[1], b[2] - a[2]
        x, y, z = c[0] - a[0], c[1] - a[1], c[2] - a[2]
        n0, n1, n2 = v * z - w * y, w * x - u * z, u * y - v * x
        length = np.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
        if length > 1e-9:
            length = -length if n2 < 0 else length
            n0, n1, n2 = n0 / length, n1 / length, n2 / length
            planes[count] = (n0, n1, n2, n0 * a[0] + n1 * a[1] + n2 * a[2])
            count += 1
    return planes[:count]


@njit(cache=True)  # type: ignore[untyped-decorator]
def counts_near(points: Float, planes: Float, margin_m: float) -> Int:
    """Return how many points lie within a margin of each plane, shape (M,)."""
    counts = np.zeros(len(planes), dtype=np.int64)
    for k in range(len(planes)):
        n0, n1, n2, d = planes[k]
        near = 0
        for i in range(len(points)):
            near += abs(points[i, 0] * n0 + points[i, 1] * n1 + points[i, 2] * n2 - d) < margin_m
        counts[k] = near
    return counts
