"""ISS keypoints (Zhong 2009): points whose neighbourhood varies in all three directions."""

import numpy as np
from executive_plugins.registration.eigen import sorted_eigenvectors
from numba import njit

from executive.arrays import Float, Int

_LEAST_NEIGHBOURS = 6  # fewer determine neither a normal nor a keypoint
# Largest ratio of consecutive eigenvalues, Zhong's γ21 and γ32. Axes of a larger ratio cannot be
# told apart.
_LARGEST_RATIO = 0.975


@njit(cache=True)  # type: ignore[untyped-decorator]
def surface_shapes(points: Float, starts: Int, rows: Int) -> tuple[Float, Float]:
    """Return outward normals and saliencies of one segment's points.

    Normals point away from the segment's centroid, which is the same side in both maps whatever
    their frames.

    Args:
        points: Points of one segment [m], shape (N, 3).
        starts: Where each point's neighbours within the salient radius begin in `rows`, shape
            (N + 1,).
        rows: Indices of the neighbours; each point is its own neighbour, too.

    Returns:
        Unit normals (N, 3), zero where there are too few neighbours. Saliencies (N,): the smallest
        eigenvalue of the scatter in which each neighbour is weighted by one over its own number of
        neighbours; zero where the axes cannot be told apart.
    """
    normals, saliencies = np.zeros(points.shape), np.zeros(len(points))
    middle = np.array([points[:, 0].mean(), points[:, 1].mean(), points[:, 2].mean()])
    scatter, covariance = np.empty((3, 3)), np.empty((3, 3))
    for i in range(len(points)):
        if starts[i + 1] - starts[i] < _LEAST_NEIGHBOURS:
            continue
        _moments(points, starts, rows, i, (scatter, covariance))
        values = sorted_eigenvectors(scatter)[0]
        if values[1] < _LARGEST_RATIO * values[0] and values[2] < _LARGEST_RATIO * values[1]:
            saliencies[i] = values[2]
        axes = sorted_eigenvectors(covariance)[1]
        outward = 1.0 if axes[2] @ (points[i] - middle) >= 0 else -1.0
        normals[i] = outward * axes[2]
    return normals, saliencies


@njit(cache=True)  # type: ignore[untyped-decorator]
def _moments(points: Float, starts: Int, rows: Int, i: int, moments: tuple[Float, Float]) -> None:
    """Compute, in place, the weighted scatter of the neighbours about point i, and their covariance
    about their mean.

    Sums are in names of their own, so that they stay in the processor's registers.
    """
    scatter, covariance = moments
    count, weights = starts[i + 1] - starts[i], 0.0
    x, y, z = 0.0, 0.0, 0.0
    xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    sxx, sxy, sxz, syy, syz, szz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(starts[i], starts[i + 1]):
        j = rows[k]
        weight = 1.0 / (starts[j + 1] - starts[j])
        weights += weight
        u, v, w = (
            points[j, 0] - points[i, 0],
            points[j, 1] - points[i, 1],
            points[j, 2] - points[i, 2],
        )
        x, y, z = x + u, y + v, z + w
        xx, xy, xz = xx + u * u, xy + u * v, xz + u * w
        yy, yz, zz = yy + v * v, yz + v * w, zz + w * w
        sxx, sxy, sxz = sxx + weight * (u * u), sxy + weight * (u * v), sxz + weight * (u * w)
        syy, syz, szz = syy + weight * (v * v), syz + weight * (v * w), szz + weight * (w * w)
    _fill(scatter, (sxx, sxy, sxz, syy, syz, szz))
    _fill(covariance, (xx, xy, xz, yy, yz, zz))
    mean = (x, y, z)
    for a in range(3):
        for b in range(3):
            covariance[a, b] = covariance[a, b] / count - mean[a] * mean[b] / count**2
            scatter[a, b] /= weights


@njit(cache=True)  # type: ignore[untyped-decorator]
def _fill(matrix: Float, upper: tuple[float, float, float, float, float, float]) -> None:
    """Fill a symmetric matrix by its upper triangle, row by row."""
    xx, xy, xz, yy, yz, zz = upper
    matrix[0, 0], matrix[0, 1], matrix[0, 2] = xx, xy, xz
    matrix[1, 0], matrix[1, 1], matrix[1, 2] = xy, yy, yz
    matrix[2, 0], matrix[2, 1], matrix[2, 2] = xz, yz, zz


@njit(cache=True)  # type: ignore[untyped-decorator]
def salient_points(saliencies: Float, starts: Int, rows: Int) -> Int:
    """Return the rows of the points that no neighbour exceeds in saliency, in rising order."""
    chosen = np.empty(len(saliencies), dtype=np.int64)
    count = 0
    for i in range(len(saliencies)):
        stands_out, k = saliencies[i] > 0, starts[i]
        while stands_out and k < starts[i + 1]:
            stands_out = saliencies[rows[k]] <= saliencies[i]
            k += 1
        if stands_out:
            chosen[count] = i
            count += 1
    return chosen[:count]
