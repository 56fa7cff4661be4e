"""Candidate motions from the arrangement of the segments' centroids, without descriptors.

Deviation from Mascaro 2020, Sec. 4.4 step 4, where motions come from descriptors alone: FPFH
descriptors of a partly seen stone match in one case of ten. Here, each two pairs of centroids of
the same distance give a planar motion that also aligns the ground planes. These motions are ranked
and tested like those from descriptors.

Time and memory are bounded whatever the number of segments: pairs are of near neighbours, an even
share of all motions is tried where there are too many, and support is looked up in a grid.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.registration.motion_proposer import MotionProposer
from executive_plugins.registration.settings import SegmentSettings
from executive_plugins.registration.stopwatch import Stopwatch
from numba import njit

from executive.arrays import Float, Int
from executive.geometry.pose import inverse, pose
from executive.geometry.rigid_fit import rigid_fit
from executive.messages.segment import Segmentation

_LEAST_PAIR_M = 0.8  # closer centroids do not determine the heading well
_DUPLICATE_M = 0.3  # motions are the same if no centroid differs by more
_NEIGHBOURS = 11  # each centroid pairs with so many nearest ones: with all, up to 12 segments
_MOST_MOTIONS = 60_000  # that are ranked: some 30 ms for 100 segments
_MOST_CELLS = 250_000  # of the grid in which support is looked up


@dataclass(frozen=True, slots=True)
class Constellation(MotionProposer):
    """Propose from where the segments stand."""

    settings: SegmentSettings

    def propose(self, target: Segmentation, source: Segmentation, watch: Stopwatch) -> list[Float]:
        """Return the motions that most centroids support; see `MotionProposer.propose`."""
        s = self.settings
        stars = [
            (np.array([one.centroid for one in x.segments]).reshape(-1, 3), x.ground_plane)
            for x in (target, source)
        ]
        with watch.stage("verification"):
            return [
                *constellation_transforms(
                    stars[0], stars[1], s.pair_tolerance_m, s.max_match_m, s.candidates
                )
            ]

    @classmethod
    def compile(cls) -> None:
        """Compile the inner loops."""
        star = np.array([[0.0, 0, 0], [2, 0, 0], [0, 3, 0]]), np.array([0.0, 0, 1, 0])
        constellation_transforms(star, star, 0.5, 1.0, 3)


def constellation_transforms(
    target: tuple[Float, Float],
    source: tuple[Float, Float],
    tolerance_m: float,
    vote_m: float,
    count: int,
) -> Float:
    """Return motions that align pairs of centroids, those that most centroids support first.

    Args:
        target: Segment centroids (N, 3) and ground plane (4,) of the target.
        source: The same of the source.
        tolerance_m: Allowed difference of a pair's distances [m]; the centroid of a stone seen from
            one side is off by up to 0.3 m.
        vote_m: Distance up to which a third centroid supports a motion [m].
        count: Most motions to return.

    Returns:
        T_target_source, shape (at most count, 4, 4).
    """
    T_level_t, T_level_s = level_pose(target[1]), level_pose(source[1])
    t, s = (
        centroids @ T[:3, :3].T + T[:3, 3]
        for (centroids, _), T in ((target, T_level_t), (source, T_level_s))
    )
    if min(len(t), len(s)) < 2:
        return np.empty((0, 4, 4))
    headings = _hypotheses(t[:, :2], s[:, :2], tolerance_m)
    grid = _nearest_grid(t[:, :2], vote_m)
    support = _support(headings, s[:, :2], t[:, :2], *grid, vote_m)
    order = np.argsort(-support, kind="stable")
    chosen = _distinct(headings, order, s[:, :2], count)
    return np.array(
        [inverse(T_level_t) @ _planar(headings[h], t, s, vote_m) @ T_level_s for h in chosen]
    )


def level_pose(plane: Float) -> Float:
    """Return T_level_cloud: z along the ground's normal, zero on the ground."""
    x = np.cross([0.0, 1.0, 0.0], plane[:3])
    x /= np.linalg.norm(x)
    return pose(np.vstack([x, np.cross(plane[:3], x), plane[:3]]), np.array([0.0, 0.0, -plane[3]]))


def _hypotheses(t: Float, s: Float, tolerance_m: float) -> Float:
    """Return planar motions (R | t) of two pairs of similar distance each, shape (H, 2, 3).

    There are at most `_MOST_MOTIONS`: of more, every n-th.
    """
    pairs = _neighbour_pairs(t), _neighbour_pairs(s)
    total = _count_motions(t, s, *pairs, tolerance_m)
    return np.asarray(_motions(t, s, *pairs, tolerance_m, -(-total // _MOST_MOTIONS) or 1))


def _neighbour_pairs(centroids: Float) -> Int:
    """Return the pairs (i, j), i < j, in which one is among the other's nearest, shape (P, 2)."""
    squares = ((centroids[:, None] - centroids) ** 2).sum(axis=2)
    nearest = np.argsort(squares, axis=1, kind="stable")[:, : _NEIGHBOURS + 1]
    pairs = np.stack(np.broadcast_arrays(np.arange(len(centroids))[:, None], nearest), axis=2)
    both = np.unique(np.sort(pairs.reshape(-1, 2), axis=1), axis=0)
    return np.asarray(both[both[:, 0] < both[:, 1]])


@njit(cache=True)  # type: ignore[untyped-decorator]
def _length(points: Float, pair: Int) -> float:
    x, y = points[pair[1]] - points[pair[0]]
    return np.sqrt(x * x + y * y)  # type: ignore[no-any-return]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _count_motions(t: Float, s: Float, pairs_t: Int, pairs_s: Int, tolerance_m: float) -> int:
    lengths = np.sort(np.array([_length(t, pair) for pair in pairs_t]))
    count = 0
    for pair in pairs_s:
        length = _length(s, pair)
        if length >= _LEAST_PAIR_M:
            count += np.searchsorted(lengths, length + tolerance_m, side="right")
            count -= np.searchsorted(lengths, length - tolerance_m, side="left")
    return 2 * count


@njit(cache=True)  # type: ignore[untyped-decorator]
def _motions(
    t: Float, s: Float, pairs_t: Int, pairs_s: Int, tolerance_m: float, every: int
) -> Float:
    found, seen = np.empty((_MOST_MOTIONS + 2, 2, 3)), 0
    kept, lengths = 0, np.array([_length(t, pair) for pair in pairs_t])
    for pair_s in pairs_s:
        length, d_s = _length(s, pair_s), s[pair_s[1]] - s[pair_s[0]]
        if length < _LEAST_PAIR_M:
            continue
        middle_s, yaw_s = 0.5 * (s[pair_s[0]] + s[pair_s[1]]), np.arctan2(d_s[1], d_s[0])
        for p, pair_t in enumerate(pairs_t):
            if abs(lengths[p] - length) > tolerance_m:
                continue
            d_t, middle_t = t[pair_t[1]] - t[pair_t[0]], 0.5 * (t[pair_t[0]] + t[pair_t[1]])
            for sign in (1.0, -1.0):
                seen += 1
                if (seen - 1) % every or kept == len(found):
                    continue
                yaw = np.arctan2(sign * d_t[1], sign * d_t[0]) - yaw_s
                c, w = np.cos(yaw), np.sin(yaw)
                found[kept, 0] = (c, -w, middle_t[0] - c * middle_s[0] + w * middle_s[1])
                found[kept, 1] = (w, c, middle_t[1] - w * middle_s[0] - c * middle_s[1])
                kept += 1
    return found[:kept]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _nearest_grid(t: Float, vote_m: float) -> tuple[Int, Float, float]:
    """Return the nearest centroid of each cell, −1 beyond the vote's reach; corner and edge [m]."""
    low = np.array([t[:, 0].min(), t[:, 1].min()]) - vote_m
    spans = np.array([t[:, 0].max(), t[:, 1].max()]) + vote_m - low
    cell_m = max(0.1 * vote_m, np.sqrt(spans[0] * spans[1] / _MOST_CELLS))
    nx, ny = int(spans[0] / cell_m) + 1, int(spans[1] / cell_m) + 1
    nearest, squares = np.full((nx, ny), -1), np.full((nx, ny), (vote_m + cell_m) ** 2)
    reach = int(vote_m / cell_m) + 2
    for n in range(len(t)):
        cx, cy = int((t[n, 0] - low[0]) / cell_m), int((t[n, 1] - low[1]) / cell_m)
        for i in range(max(cx - reach, 0), min(cx + reach + 1, nx)):
            for j in range(max(cy - reach, 0), min(cy + reach + 1, ny)):
                dx = low[0] + (i + 0.5) * cell_m - t[n, 0]
                dy = low[1] + (j + 0.5) * cell_m - t[n, 1]
                if dx * dx + dy * dy < squares[i, j]:
                    squares[i, j], nearest[i, j] = dx * dx + dy * dy, n
    return nearest, low, cell_m


@njit(cache=True)  # type: ignore[untyped-decorator]
def _support(
    headings: Float, s: Float, t: Float, nearest: Int, low: Float, cell_m: float, vote_m: float
) -> Float:
    """Return for each motion by how much its centroids are nearer to others than the vote's reach,
    in sum [m].
    """
    nx, ny = nearest.shape
    names, targets = nearest.reshape(-1) + 1, np.full((len(t) + 1, 2), np.inf)  # the first is none
    targets[1:] = t
    support, cells = np.zeros(len(headings)), np.empty(len(s), dtype=np.int32)
    us, vs, xs, ys = s[:, 0].copy(), s[:, 1].copy(), np.empty(len(s)), np.empty(len(s))
    for h in range(len(headings)):
        (a, b, c), (d, e, f) = headings[h]
        # Step by step for all centroids, as processors then take several at once: a third of the
        # time. Beyond the border no target is within reach, so that its cells serve.
        for n in range(len(s)):
            xs[n], ys[n] = a * us[n] + b * vs[n] + c, d * us[n] + e * vs[n] + f
            i = np.int32(min(max((xs[n] - low[0]) / cell_m, 0.0), nx - 1.0))
            j = np.int32(min(max((ys[n] - low[1]) / cell_m, 0.0), ny - 1.0))
            cells[n] = i * np.int32(ny) + j
        for n in range(len(s)):
            name = names[cells[n]]
            xs[n], ys[n] = xs[n] - targets[name, 0], ys[n] - targets[name, 1]
        for n in range(len(s)):
            xs[n] = vote_m - np.sqrt(xs[n] * xs[n] + ys[n] * ys[n])
        for n in range(len(s)):
            support[h] += xs[n] if xs[n] > 0.0 else 0.0
    return support


@njit(cache=True)  # type: ignore[untyped-decorator]
def _moved(heading: Float, place: Float) -> tuple[float, float]:
    x, y = place
    return (
        heading[0, 0] * x + heading[0, 1] * y + heading[0, 2],
        heading[1, 0] * x + heading[1, 1] * y + heading[1, 2],
    )


@njit(cache=True)  # type: ignore[untyped-decorator]
def _distinct(headings: Float, order: Int, s: Float, count: int) -> Int:
    """Return the first motions that move some centroid elsewhere than each one before."""
    chosen, found = np.empty(count, dtype=np.int64), 0
    for h in order:
        is_new = True
        for c in chosen[:found]:
            farthest = 0.0
            for n in range(len(s)):
                here, there = _moved(headings[h], s[n]), _moved(headings[c], s[n])
                farthest = max(farthest, abs(here[0] - there[0]), abs(here[1] - there[1]))
                if farthest > _DUPLICATE_M:
                    break
            if farthest <= _DUPLICATE_M:
                is_new = False
                break
        if is_new:
            chosen[found] = h
            found += 1
        if found == count:
            break
    return chosen[:found]


def _planar(heading: Float, t: Float, s: Float, vote_m: float) -> Float:
    """Return a planar motion refitted to all centroids that support it, shape (4, 4).

    It is the pose between the frames that `level_pose` makes.
    """
    moved = s[:, :2] @ heading[:, :2].T + heading[:, 2]
    distances = np.linalg.norm(moved[:, None] - t[None, :, :2], axis=2)
    nearest = distances.argmin(axis=1)
    close = distances.min(axis=1) < vote_m
    flat = np.array([1.0, 1.0, 0.0])
    if close.sum() >= 2:
        return rigid_fit(
            np.vstack([t[nearest[close]] * flat, _UP + t[nearest[close]] * flat]),
            np.vstack([s[close] * flat, _UP + s[close] * flat]),
        )
    T = np.eye(4)
    T[:2, :2], T[:2, 3] = heading[:, :2], heading[:, 2]
    return T


_UP = np.array([0.0, 0.0, 1.0])  # offset of a second layer of points, which keeps the refit upright
