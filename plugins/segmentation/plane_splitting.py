"""Splitting of clusters by planes between convex bodies: stones that touch."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from executive_plugins.segmentation.shape import principal_extents, quantile, spans
from executive_plugins.segmentation.two_bodies import axes_of, best_cut, depths_under_hulls
from numba import njit
from scipy.spatial import cKDTree

from executive.arrays import Bool, Float, Int
from executive.geometry.voxels import voxel_means

_FEW = 20  # patches: fewer show no shape
_SEAM = 2.0  # width of a seam on both of its sides, in patches
_FLOOR = 1e-4  # of the longest side: shallower depths are alike
_SHARE = 0.95  # quantile of depths that is left after a cut
# Logistic regression of views of one stone and of two that touch or nearly do, on the logarithms
# of three depths in the longest side: `docs/evidence/perception.md`, neighbours.
_WEIGHTS, _OFFSET = np.array([5.83, -5.52, 6.03]), 21.84
# Logarithm of the odds from which a part that is no more hollow than one stone is cut. Of such with
# odds of 1 to e, 15 were one stone and 1 was two, as two that lie apart are parted before: seeds
# 91733046 to 91733051 of `neighbours.py`.
_LEAST_EVIDENCE = 1.0
_SHALLOW = 0.010  # mean depth, in the longest side, of what is one: pairs had 0.015 and more
_SEED = 0  # of the cuts that are tried


@dataclass(frozen=True, slots=True)
class PlaneSplitter:
    """Splits clusters into convex bodies, one plane after the other.

    Attributes:
        patch_m: Grid edge of the patches [m].
        least_extent_m: Smallest longest side of a stone [m].
        is_one: Whether points are no more hollow than one stone: others are cut in any case, and
            joined again where that was wrong.
    """

    patch_m: float
    least_extent_m: float
    is_one: Callable[[Float], bool]

    def split(self, level: Float) -> list[Int]:
        """Return the rows of each body's points, z up [m], shape (N, 3)."""
        patches = voxel_means(level, self.patch_m)
        bodies = self._joined(patches, self._cut(patches, np.arange(len(patches))))
        if len(bodies) < 2:
            return [np.arange(len(level))]
        body_of = np.empty(len(patches), dtype=np.int64)
        for number, rows in enumerate(bodies):
            body_of[rows] = number
        labels = body_of[cKDTree(patches).query(level)[1]]
        return [np.flatnonzero(labels == number) for number in np.unique(labels)]

    def evidence(self, patches: Float, axes: Float, is_beyond: Bool) -> float:
        """Return the logarithm of the odds that patches are of two bodies, on two sides of a cut,
        and not of one.
        """
        one = depths_under_hulls(patches, axes, np.zeros_like(is_beyond))
        two = depths_under_hulls(patches, axes, is_beyond)
        at_seam = _at_seam(patches, is_beyond, _SEAM * self.patch_m)
        if not at_seam.any():
            return np.inf
        longest_m = float(principal_extents(patches)[0])
        told = np.array([one.mean(), quantile(two, _SHARE), one[at_seam].mean()]) / longest_m
        return float(np.log(told + _FLOOR) @ _WEIGHTS) + _OFFSET

    def odds(self, one: Float, other: Float) -> float:
        """Return the logarithm of the odds that two sets of patches are two bodies and not one."""
        both = np.vstack([one, other])
        is_beyond = np.arange(len(both)) >= len(one)
        return self.evidence(both, axes_of(both), is_beyond)

    def _cut(self, patches: Float, rows: Int) -> list[Int]:
        part = patches[rows]
        if len(rows) < _FEW:
            return [rows]
        axes = axes_of(part)
        depth_m = depths_under_hulls(part, axes, np.zeros(len(part), dtype=bool)).mean()
        if depth_m < _SHALLOW * principal_extents(part)[0]:
            return [rows]
        is_beyond = best_cut(part, axes, np.random.default_rng(_SEED))
        sides = part[is_beyond], part[~is_beyond]
        is_small = min(spans(side).max() for side in sides) < self.least_extent_m
        if is_small:
            return [rows]
        if self.evidence(part, axes, is_beyond) <= _LEAST_EVIDENCE and self.is_one(part):
            return [rows]
        return self._cut(patches, rows[is_beyond]) + self._cut(patches, rows[~is_beyond])

    def _joined(self, patches: Float, bodies: list[Int]) -> list[Int]:
        """Join bodies that are one together: a plane between two may have cut a third."""
        bodies = list(bodies)
        pairs = combinations(range(len(bodies)), 2)
        odds = {pair: self._odds(patches, bodies, pair) for pair in pairs}
        while odds:
            (one, other), least = min(odds.items(), key=lambda item: (item[1], item[0]))
            if least > 0:
                break
            bodies[one] = np.sort(np.concatenate([bodies[one], bodies[other]]))
            bodies[other] = np.array([], dtype=np.int64)
            odds = {pair: value for pair, value in odds.items() if other not in pair}
            for pair in odds:
                if one in pair:
                    odds[pair] = self._odds(patches, bodies, pair)
        return [body for body in bodies if len(body)]

    def _odds(self, patches: Float, bodies: list[Int], pair: tuple[int, int]) -> float:
        """Return the evidence for two bodies; infinite if they are no neighbours."""
        one, other = (bodies[k] for k in pair)
        if cKDTree(patches[one]).query(patches[other])[0].min() > _SEAM * self.patch_m:
            return np.inf
        return self.odds(patches[one], patches[other])


@njit(cache=True)  # type: ignore[untyped-decorator]
def _at_seam(patches: Float, is_beyond: Bool, reach_m: float) -> Bool:
    """Return which patches have one of the other side of a cut within a reach [m], shape (N,).

    All pairs are looked at, as there are few patches.
    """
    found = np.zeros(len(patches), dtype=np.bool_)
    rows, others = np.flatnonzero(is_beyond), np.flatnonzero(~is_beyond)
    for i in rows:
        for j in others:
            x = patches[i, 0] - patches[j, 0]
            y = patches[i, 1] - patches[j, 1]
            z = patches[i, 2] - patches[j, 2]
            if x * x + y * y + z * z < reach_m * reach_m:
                found[i] = found[j] = True
    return found
