"""Depth of one picture by sweeping planes through the scene and comparing it with its neighbours on
each.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Float, Int

Grey = NDArray[np.float32]
_LEAST_DEVIATION = 1.5  # of grey values 0 … 255 in a window: below, there is nothing to compare
_TILE = 32  # pixels along the side of a tile whose planes are chosen together
_MANY_PLANES = 16  # from which planes are chosen on smaller pictures first
_LEAST_COARSE, _LEAST_FOUND = 0.5, 0.1  # correlation, and share of a tile's pixels, that choose
_BEYOND = 4  # planes beyond those chosen: two of the smaller pictures' steps


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

    def rays(self, rows: slice = slice(None)) -> Float:
        """Return the direction of each pixel in the world, of length one along the optical axis,
        shape (h, w, 3), or of some rows.
        """
        height, width = self.grey.shape
        u, v = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float)[rows])
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
    index, score = _indices(view, neighbours, normal, offsets_m, window_px // 2)
    offset = offsets_m[0] + index * (offsets_m[1] - offsets_m[0])
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (offset - normal @ view.centre) / _climb(view, normal)
    return np.where((index >= 0) & (depth > 0), depth, np.nan), score.astype(np.float64)


def _climb(view: View, normal: Float) -> Float:
    """Return by how much each pixel's ray rises along a normal, shape (h, w): `rays` @ normal."""
    du, dv, at_first = (view.T_optical_world[:3, :3] @ normal) @ np.linalg.inv(view.K)
    height, width = view.grey.shape
    return np.asarray(np.add.outer(dv * np.arange(height), du * np.arange(width)) + at_first)


def _indices(
    view: View, neighbours: Sequence[View], normal: Float, offsets_m: Float, half: int
) -> tuple[Grey, Grey]:
    """Return the best plane of each pixel, between planes, and its score; −1 for none, (h, w).

    Of many planes, each tile is compared on those only that every other plane on pictures of half
    the size has shown to be near a surface there: eight times less work a level, and then as much
    as the scene is rough.
    """
    H = np.array(
        [[_homography(view, other, normal, offset) for other in neighbours] for offset in offsets_m]
    )
    greys = np.stack([other.grey for other in neighbours])
    ranges = np.empty((*_tiles(view.grey.shape), 2), dtype=np.int64)
    ranges[:] = 0, len(offsets_m) - 1
    if len(offsets_m) >= _MANY_PLANES and min(view.grey.shape) >= 4 * _TILE:
        halved = [_halved(one) for one in (view, *neighbours)]
        coarse, score = _indices(halved[0], halved[1:], normal, offsets_m[::2], half)
        found = np.where(score >= _LEAST_COARSE, coarse, np.float32(-1))
        ranges = _near(2 * found, ranges.shape[:2], len(offsets_m))
    return _sweep(np.array(view.grey), greys, H.astype(np.float32), half, ranges)  # type: ignore[no-any-return]


def _tiles(shape: tuple[int, ...]) -> tuple[int, int]:
    """Return the number of tiles along a picture's height and width."""
    return -(-shape[0] // _TILE), -(-shape[1] // _TILE)


def _halved(view: View) -> View:
    """Return a view whose pixels are the means of four."""
    height, width = (side // 2 for side in view.grey.shape)
    grey = view.grey[: 2 * height, : 2 * width].reshape(height, 2, width, 2).mean(axis=(1, 3))
    K = view.K.copy()
    K[:2] /= 2
    K[:2, 2] -= 0.25  # the middle of the first pixel is between four
    return View(grey, K, view.T_optical_world)


def _near(found: Grey, tiles: tuple[int, int], planes: int) -> Int:
    """Return the first and last plane to compare in each tile, shape (*tiles, 2).

    Args:
        found: Best plane of each pixel of the halved picture; negative for none, shape (h, w).
        tiles: Tiles along height and width.
        planes: Number of planes; a tile around which hardly any pixel was found takes all of them.
    """
    ranges = np.empty((*tiles, 2), dtype=np.int64)
    ranges[:] = 0, planes - 1
    side = _TILE // 2
    for i in range(tiles[0]):
        for j in range(tiles[1]):
            around = found[
                max(i * side - side // 2, 0) : (i + 1) * side + side // 2,
                max(j * side - side // 2, 0) : (j + 1) * side + side // 2,
            ]
            seen = around[around >= 0]
            if len(seen) >= _LEAST_FOUND * around.size:
                low, high = int(seen.min()) - _BEYOND, int(np.ceil(seen.max())) + _BEYOND
                ranges[i, j] = max(low, 0), min(high, planes - 1)
    return ranges


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


@njit(cache=True, nogil=True)
def _sweep(grey, greys, H, half, ranges):  # type: ignore[no-untyped-def]
    """Return the best plane of each pixel, between planes, and its score; −1 for none,
    both (h, w): tile by tile, each on the planes of its range.
    """
    height, width = grey.shape
    mean = _box(grey, half)
    deviation = np.sqrt(np.maximum(_box(grey * grey, half) - mean * mean, 0))
    index, best = np.full_like(grey, -1), np.full_like(grey, -1)
    for i in range(ranges.shape[0]):
        for j in range(ranges.shape[1]):
            top, left = max(i * _TILE - half, 0), max(j * _TILE - half, 0)
            low, right = min((i + 1) * _TILE + half, height), min((j + 1) * _TILE + half, width)
            deviations = deviation[top:low, left:right].copy()
            if (deviations > _LEAST_DEVIATION).sum() == 0:
                continue
            # Homographies count from the tile's first pixel.
            planes = H[ranges[i, j, 0] : ranges[i, j, 1] + 1].copy()
            for axis in range(3):
                planes[:, :, axis, 2] += planes[:, :, axis, 0] * left + planes[:, :, axis, 1] * top
            part, score = _sweep_tile(
                grey[top:low, left:right].copy(),
                mean[top:low, left:right].copy(),
                deviations,
                greys,
                planes,
                half,
            )
            v0, u0 = i * _TILE, j * _TILE
            v1, u1 = min(v0 + _TILE, height), min(u0 + _TILE, width)
            own = part[v0 - top : v1 - top, u0 - left : u1 - left]
            index[v0:v1, u0:u1] = np.where(own >= 0, own + ranges[i, j, 0], own)
            best[v0:v1, u0:u1] = score[v0 - top : v1 - top, u0 - left : u1 - left]
    return index, best


@njit(cache=True, nogil=True)
def _sweep_tile(grey, mean, deviation, greys, H, half):  # type: ignore[no-untyped-def]
    """Return the best plane of each pixel of a tile, between planes, and its score."""
    planes, others = H.shape[:2]
    best = np.full_like(grey, -1)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def _score_row(v, half, sums, mean, deviation, is_seen, score):  # type: ignore[no-untyped-def]
    """Slide the window along one row."""
    low, high = v - half, v + half
    share = 1.0 / (2 * half + 1) ** 2
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
        variance = share * (b - share * a * a)
        if variance > _LEAST_DEVIATION**2:
            score[v, i] = share * (c - a * mean[v, i]) / (deviation[v, i] * np.sqrt(variance))


@njit(cache=True, nogil=True)
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
