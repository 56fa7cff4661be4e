"""Planes through the neighbours of points, and whether those neighbours make a plane at all."""

import math

import numpy as np
from numba import njit

from executive.arrays import Float, Int

NO_PLANE = np.inf  # the elongation of points that coincide


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def tangent_planes(points: Float, rows: Int) -> tuple[Float, Float]:  # pragma: no cover - compiled
    """Fit a plane to each set of points by least squares.

    Args:
        points: Positions [m], shape (N, 3).
        rows: The points of each set, shape (M, k).

    Returns:
        Unit normals, shape (M, 3), and how many times as long as wide each set is within its plane,
        as a ratio of standard deviations, shape (M,).
    """
    normals, elongations = np.zeros((len(rows), 3)), np.empty(len(rows))
    spread = np.empty(6)
    for m in range(len(rows)):
        _spread(points, rows[m], spread)
        elongations[m] = _plane(spread, normals[m])
    return normals, elongations


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _spread(points: Float, rows: Int, spread: Float) -> None:  # pragma: no cover - compiled
    """Write the covariance of points: xx, yy, zz, xy, xz, yz."""
    count = len(rows)
    mx, my, mz = 0.0, 0.0, 0.0
    for row in rows:
        mx, my, mz = mx + points[row, 0], my + points[row, 1], mz + points[row, 2]
    mx, my, mz = mx / count, my / count, mz / count
    spread[:] = 0.0
    for row in rows:
        x, y, z = points[row, 0] - mx, points[row, 1] - my, points[row, 2] - mz
        spread[0] += x * x
        spread[1] += y * y
        spread[2] += z * z
        spread[3] += x * y
        spread[4] += x * z
        spread[5] += y * z
    spread /= count


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _plane(spread: Float, normal: Float) -> float:  # pragma: no cover - compiled
    """Write the eigenvector of the smallest eigenvalue; return the elongation.

    Eigenvalues of a symmetric 3×3 matrix in closed form (Smith 1961), some twenty times as fast as
    LAPACK for one matrix.
    """
    a, b, c, d, e, f = spread
    mean = (a + b + c) / 3
    a, b, c = a - mean, b - mean, c - mean
    scale = math.sqrt((a * a + b * b + c * c + 2 * (d * d + e * e + f * f)) / 6)
    if scale <= 0.0:
        normal[2] = 1.0
        return NO_PLANE
    half = (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)) / (2 * scale**3)
    angle = math.acos(min(max(half, -1.0), 1.0)) / 3
    largest = 2 * scale * math.cos(angle)
    least = 2 * scale * math.cos(angle + 2 * math.pi / 3)
    middle = -largest - least + mean
    a, b, c = a - least, b - least, c - least
    # The normal is across two rows of the matrix less its eigenvalue: the two that tell most.
    best = 0.0
    for x, y, z in (
        (d * f - e * b, e * d - a * f, a * b - d * d),
        (d * c - e * f, e * e - a * c, a * f - d * e),
        (b * c - f * f, f * e - d * c, d * f - b * e),
    ):
        square = x * x + y * y + z * z
        if square > best:
            best = square
            normal[0], normal[1], normal[2] = x, y, z
    if best <= 0.0:
        normal[0], normal[1], normal[2] = 0.0, 0.0, 1.0
        return NO_PLANE
    normal /= math.sqrt(best)
    if middle <= 0.0:
        return NO_PLANE
    return math.sqrt((largest + mean) / middle)
