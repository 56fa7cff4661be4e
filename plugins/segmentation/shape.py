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
    mean, scatter = np.zeros(3), np.zeros((3, 3))
    for i in range(len(points)):
        mean += points[i]
    mean /= max(len(points), 1)
    for i in range(len(points)):
        x, y, z = points[i, 0] - mean[0], points[i, 1] - mean[1], points[i, 2] - mean[2]
        scatter[0, 0] += x * x
        scatter[0, 1] += x * y
        scatter[0, 2] += x * z
        scatter[1, 1] += y * y
        scatter[1, 2] += y * z
        scatter[2, 2] += z * z
    scatter[1, 0], scatter[2, 0], scatter[2, 1] = scatter[0, 1], scatter[0, 2], scatter[1, 2]
    return mean, scatter


@njit(cache=True)  # type: ignore[untyped-decorator]
def spans(points: Float, axes: Float = _AXES) -> Float:
    """Return the extents along axes, given as columns [m], shape (3,)."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for i in range(len(points)):
        for a in range(3):
            along = (
                points[i, 0] * axes[0, a] + points[i, 1] * axes[1, a] + points[i, 2] * axes[2, a]
            )
            low[a], high[a] = min(low[a], along), max(high[a], along)
    extents: Float = high - low
    return extents


def principal_extents(points: Float) -> Float:
    """Return the side lengths of the box along the principal axes, longest first [m],
    shape (3,).
    """
    axes = np.linalg.eigh(moments(points)[1])[1]
    return np.asarray(np.sort(spans(points, axes))[::-1])


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
