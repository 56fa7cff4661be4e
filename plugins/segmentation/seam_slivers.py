"""Slivers along the seam of two stones, which cuts leave over: each of their points goes back to
the stone that it is of.

A plane that misses a seam, or a valley beside it, cuts off a thin third part, of which some points
are of one stone and some of the other. To join it with either as a whole makes that one hollow.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from executive_plugins.segmentation.two_bodies import half_sphere
from numba import njit
from scipy.spatial import cKDTree

from executive.arrays import Float, Int
from executive.geometry.voxels import voxel_means

_SEAM = 2.0  # width of a seam on both of its sides, in patches
_MOST_AWAY = 0.5  # share of a sliver outside of seams: most of a stone is its own surface
_AXES = half_sphere(64)  # along which hulls are measured


@dataclass(frozen=True, slots=True)
class SeamSlivers:
    """Gives slivers to the parts beside them.

    Attributes:
        patch_m: Grid edge of the patches [m].
        least_points: Fewest points of a stone: a part that has fewer is given away in any case.
        odds: Logarithm of the odds that two sets of patches are two bodies and not one.
    """

    patch_m: float
    least_points: int
    odds: Callable[[Float, Float], float]

    def given_back(self, level: Float, parts: list[Int]) -> list[Int]:
        """Return the rows of each part, with the rows of slivers among those of their neighbours.

        A sliver lies mostly beside larger parts, and what each of these gets is likelier one body
        with it than two.

        Args:
            level: Points of a cluster, z up [m], shape (N, 3).
            parts: Rows of each part's points.
        """
        parts = list(parts)
        patches = [voxel_means(level[part], self.patch_m) for part in parts] if parts[1:] else []
        for n in sorted(range(len(parts)), key=lambda n: len(parts[n])):
            larger = [k for k in range(len(parts)) if len(parts[k]) > len(parts[n])]
            beside = self._beside(patches[n], [patches[k] for k in larger]) if larger else []
            neighbours = [larger[k] for k in beside]
            shares = self._shares(level, parts[n], [(parts[k], patches[k]) for k in neighbours])
            for k, rows in zip(neighbours, shares, strict=False):
                parts[k] = np.sort(np.concatenate([parts[k], rows]))
                patches[k] = voxel_means(level[parts[k]], self.patch_m)
            if shares:
                parts[n] = parts[n][:0]
        return [part for part in parts if len(part)]

    def _beside(self, patches: Float, others: list[Float]) -> list[int]:
        """Return which parts a sliver is beside; none if most of it is away from all of them."""
        reach_m = _SEAM * self.patch_m
        away_m = np.array([cKDTree(other).query(patches)[0] for other in others])
        if (away_m.min(axis=0) > reach_m).mean() > _MOST_AWAY:
            return []
        return [int(k) for k in np.flatnonzero(away_m.min(axis=1) <= reach_m)]

    def _shares(self, level: Float, part: Int, others: list[tuple[Int, Float]]) -> list[Int]:
        """Return the rows of a part that are each neighbour's; nothing if it is no sliver."""
        is_small = len(part) < self.least_points
        if len(others) < (1 if is_small else 2):
            return []
        points = level[part]
        owner = np.argmin([_beyond(points, level[rows]) for rows, _ in others], axis=0)
        shares = [part[owner == k] for k in range(len(others))]
        if is_small:
            return shares
        pairs = [
            (one, patches) for one, (_, patches) in zip(shares, others, strict=True) if len(one)
        ]
        if len(pairs) < 2 or any(self._is_two(level[one], patches) for one, patches in pairs):
            return []
        return shares

    def _is_two(self, share: Float, patches: Float) -> bool:
        return self.odds(patches, voxel_means(share, self.patch_m)) > 0


def _beyond(points: Float, body: Float) -> Float:
    """Return how far each point is beyond the hull of a body [m], below 0 inside, shape (N,)."""
    return np.asarray(_most_beyond(points @ _AXES.T, body @ _AXES.T))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _most_beyond(along: Float, body: Float) -> Float:
    """Return the largest overhang over the ends of a body along the axes [m], shape (N,)."""
    lowest, highest = np.full(body.shape[1], np.inf), np.full(body.shape[1], -np.inf)
    for i in range(len(body)):
        for a in range(body.shape[1]):
            lowest[a], highest[a] = min(lowest[a], body[i, a]), max(highest[a], body[i, a])
    found = np.full(len(along), -np.inf)
    for i in range(len(along)):
        for a in range(body.shape[1]):
            found[i] = max(found[i], lowest[a] - along[i, a], along[i, a] - highest[a])
    return found
