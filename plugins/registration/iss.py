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
    scatter, covariance, mean = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    for i in range(len(points)):
        count = starts[i + 1] - starts[i]
        if count < _LEAST_NEIGHBOURS:
            continue
        weight_sum = _moments(points, starts, rows, i, (scatter, covariance, mean))
        for a in range(3):
            for b in range(3):
                covariance[a, b] = covariance[a, b] / count - mean[a] * mean[b] / count**2
                scatter[a, b] /= weight_sum
        values, axes = sorted_eigenvectors(scatter)
        if values[1] < _LARGEST_RATIO * values[0] and values[2] < _LARGEST_RATIO * values[1]:
            saliencies[i] = values[2]
        axes = sorted_eigenvectors(covariance)[1]
        outward = 1.0 if axes[2] @ (points[i] - middle) >= 0 else -1.0
        normals[i] = outward * axes[2]
    return normals, saliencies


@njit(cache=True)  # type: ignore[untyped-decorator]
def _moments(
    points: Float, starts: Int, rows: Int, i: int, sums: tuple[Float, Float, Float]
) -> float:
    """Compute, in place, the moments of the neighbours about point i; return the sum of weights."""
    scatter, covariance, mean = sums
    scatter[:], covariance[:], mean[:] = 0.0, 0.0, 0.0
    weight_sum = 0.0
    for k in range(starts[i], starts[i + 1]):
        j = rows[k]
        weight = 1.0 / (starts[j + 1] - starts[j])
        weight_sum += weight
        for a in range(3):
            d_a = points[j, a] - points[i, a]
            mean[a] += d_a
            for b in range(3):
                product = d_a * (points[j, b] - points[i, b])
                covariance[a, b] += product
                scatter[a, b] += weight * product
    return weight_sum


@njit(cache=True)  # type: ignore[untyped-decorator]
def salient_points(saliencies: Float, starts: Int, rows: Int) -> Int:
    """Return the rows of the points that no neighbour exceeds in saliency, in rising order."""
    chosen = np.empty(len(saliencies), dtype=np.int64)
    count = 0
    for i in range(len(saliencies)):
        stands_out = saliencies[i] > 0
        for k in range(starts[i], starts[i + 1]):
            stands_out = stands_out and saliencies[rows[k]] <= saliencies[i]
        if stands_out:
            chosen[count] = i
            count += 1
    return chosen[:count]
