"""Depth of one picture by sweeping planes through the scene and comparing it with its neighbours on
each.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Float

Grey = NDArray[np.float32]
_LEAST_DEVIATION = 1.5  # of grey values 0 … 255 in a window: below, there is nothing to compare


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A picture without lens distortion, and where it was taken.

    Attributes:
        grey: Brightness 0 … 255, shape (height, width).
        K: Pinhole matrix: pixel coordinates (0, 0) are the middle of the first pixel, shape (3, 3).
        T_optical_world: Pose of the world in the camera (x right, y down, z forward), shape (4, 4).
    """

    grey: Grey
    K: Float
    T_optical_world: Float

    @property
    def centre(self) -> Float:
        """Position of the camera in the world [m], shape (3,)."""
        T = self.T_optical_world
        return np.asarray(-T[:3, :3].T @ T[:3, 3])

    def rays(self) -> Float:
        """Return the direction of each pixel in the world, of length one along the optical axis,
        shape (h, w, 3).
        """
        height, width = self.grey.shape
        u, v = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
        pixels = np.stack([u, v, np.ones_like(u)], axis=-1)
        return np.asarray(pixels @ np.linalg.inv(self.K).T @ self.T_optical_world[:3, :3])


def sweep(
    view: View, neighbours: Sequence[View], normal: Float, offsets_m: Float, window_px: int
) -> tuple[Float, Float]:
    """Return the depth [m] of each pixel along the optical axis, and how surely it is right, both
    (h, w).

    On each plane n·X = offset, the neighbours are drawn as the picture would see them, and compared
    with it by normalised cross-correlation over a window; a pixel lies on the plane where the mean
    of its two best neighbours is highest: whoever does not see it has no say. A parabola through
    the scores finds it between the planes.

    Args:
        view: The picture.
        neighbours: At least one.
        normal: Unit normal of the planes, in the world: of the ground, so that windows on it are
            not slanted, (3,).
        offsets_m: Of the planes, evenly spaced and rising, shape (P,).
        window_px: Side of the window, odd.

    Returns:
        Depth, NaN where there is none, and the score −1 … 1.
    """
    H = np.array(
        [[_homography(view, other, normal, offset) for other in neighbours] for offset in offsets_m]
    )
    greys = np.stack([other.grey for other in neighbours])
    index, score = _sweep(view.grey, greys, H.astype(np.float32), window_px // 2)
    offset = offsets_m[0] + index * (offsets_m[1] - offsets_m[0])
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (offset - normal @ view.centre) / (view.rays() @ normal)
    return np.where((index >= 0) & (depth > 0), depth, np.nan), score.astype(np.float64)


def _homography(view: View, other: View, normal: Float, offset_m: float) -> Float:
    """Return how a pixel of the view that sees the plane n·X = offset appears in the other, shape
    (3, 3).
    """
    T = other.T_optical_world @ np.linalg.inv(view.T_optical_world)
    n = view.T_optical_world[:3, :3] @ normal
    distance = offset_m - normal @ view.centre  # in the camera: n·X = distance
    return np.asarray(
        other.K @ (T[:3, :3] + np.outer(T[:3, 3], n) / distance) @ np.linalg.inv(view.K)
    )


@njit(cache=True)
def _sweep(grey, greys, H, half):  # type: ignore[no-untyped-def]
    """Return the best plane of each pixel, between planes, and its score; −1 for none,
    both (h, w).
    """
    planes, others = H.shape[:2]
    mean = _box(grey, half)
    deviation = np.sqrt(np.maximum(_box(grey * grey, half) - mean * mean, 0))
    best = np.full(grey.shape, np.float32(-1))
    index, before, after, last = best.copy(), best.copy(), best.copy(), best.copy()
    for plane in range(planes):
        first, second = np.full_like(best, -1), np.full_like(best, -1)
        for other in range(others):
            drawn, is_seen = _drawn(greys[other], H[plane, other], grey.shape)
            score = _correlation(grey, mean, deviation, drawn, is_seen, half)
            second = np.maximum(second, np.minimum(first, score))
            first = np.maximum(first, score)
        score = first if others == 1 else np.float32(0.5) * (first + second)
        _keep_best(plane, score, last, best, index, before, after)
        last = score
    return _between(index, before, best, after, planes), best


@njit(cache=True)
def _keep_best(plane, score, last, best, index, before, after):  # type: ignore[no-untyped-def]
    """Enter the scores of one plane where they are the best so far, with those of the planes beside
    it.
    """
    height, width = score.shape
    for v in range(height):
        for u in range(width):
            s = score[v, u]
            if plane > 0 and index[v, u] == plane - 1:
                after[v, u] = s
            if s > best[v, u]:
                best[v, u], index[v, u], before[v, u], after[v, u] = s, plane, last[v, u], -1


@njit(cache=True)
def _between(index, before, best, after, planes):  # type: ignore[no-untyped-def]
    """Return where the parabola through three scores is highest; −1 where the best is the sweep's
    first or last.
    """
    height, width = index.shape
    out = np.full_like(index, -1)
    for v in range(height):
        for u in range(width):
            a, b, c = before[v, u], best[v, u], after[v, u]
            if 0 < index[v, u] < planes - 1 and a > -1 and c > -1 and a + c < 2 * b:
                out[v, u] = index[v, u] + 0.5 * (a - c) / (a - 2 * b + c)
    return out


@njit(cache=True)
def _drawn(other, H, shape):  # type: ignore[no-untyped-def]
    """Return another picture as it appears through H, and which pixels it shows,
    both of a shape.
    """
    height, width = shape
    rows, columns = other.shape
    drawn = np.zeros(shape, np.float32)
    is_seen = np.zeros(shape, np.bool_)
    for v in range(height):
        x0, y0, w0 = H[0, 1] * v + H[0, 2], H[1, 1] * v + H[1, 2], H[2, 1] * v + H[2, 2]
        for u in range(width):
            w = H[2, 0] * u + w0
            if w <= 0:
                continue
            x, y = (H[0, 0] * u + x0) / w, (H[1, 0] * u + y0) / w
            if x < 0 or y < 0 or x >= columns - 1 or y >= rows - 1:
                continue
            i, j = int(y), int(x)
            a, b = y - np.float32(i), x - np.float32(j)
            top = other[i, j] + b * (other[i, j + 1] - other[i, j])
            low = other[i + 1, j] + b * (other[i + 1, j + 1] - other[i + 1, j])
            drawn[v, u] = top + a * (low - top)
            is_seen[v, u] = True
    return drawn, is_seen


@njit(cache=True)
def _correlation(grey, mean, deviation, drawn, is_seen, half):  # type: ignore[no-untyped-def]
    """Return the normalised cross-correlation over windows; −1 where one has no contrast or is not
    all seen.
    """
    height, width = grey.shape
    size = 2 * half + 1
    score = np.full(grey.shape, np.float32(-1))
    sums = np.zeros(
        (3, width)
    )  # down each column of the window: of the drawn, of its square, of the product
    for v in range(height):
        for u in range(width):
            d, g = drawn[v, u], grey[v, u]
            sums[0, u] += d
            sums[1, u] += d * d
            sums[2, u] += d * g
            if v >= size:
                d, g = drawn[v - size, u], grey[v - size, u]
                sums[0, u] -= d
                sums[1, u] -= d * d
                sums[2, u] -= d * g
        if v >= size - 1:
            _score_row(v - half, half, sums, mean, deviation, is_seen, score)
    return score


@njit(cache=True)
def _score_row(v, half, sums, mean, deviation, is_seen, score):  # type: ignore[no-untyped-def]
    """Slide the window along one row."""
    low, high = v - half, v + half
    area = (2 * half + 1) ** 2
    a, b, c = 0.0, 0.0, 0.0
    for u in range(mean.shape[1]):
        a, b, c = a + sums[0, u], b + sums[1, u], c + sums[2, u]
        if u > 2 * half:
            left = u - 2 * half - 1
            a, b, c = a - sums[0, left], b - sums[1, left], c - sums[2, left]
        i = u - half
        if i < half or deviation[v, i] <= _LEAST_DEVIATION:
            continue
        if not (
            is_seen[low, i - half]
            and is_seen[low, u]
            and is_seen[high, i - half]
            and is_seen[high, u]
        ):
            continue
        variance = b / area - (a / area) ** 2
        if variance > _LEAST_DEVIATION**2:
            score[v, i] = (c / area - a / area * mean[v, i]) / (deviation[v, i] * np.sqrt(variance))


@njit(cache=True)
def _box(values, half):  # type: ignore[no-untyped-def]
    """Return the mean over a square window; 0 within half a window of the edge."""
    height, width = values.shape
    size = 2 * half + 1
    out = np.zeros_like(values)
    columns = np.zeros(width, np.float64)
    for v in range(height):
        for u in range(width):
            columns[u] += values[v, u]
            if v >= size:
                columns[u] -= values[v - size, u]
        if v < size - 1:
            continue
        total = 0.0
        for u in range(width):
            total += columns[u]
            if u >= size:
                total -= columns[u - size]
            if u >= size - 1:
                out[v - half, u - half] = total / (size * size)
    return out
