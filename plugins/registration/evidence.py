"""How likely two clouds of a site are under a motion: stones, free space and ground.

Own addition to the method of the paper, whose gate looks at matched stones only. Each patch of a
stone, and each four square metres of ground, are one observation: errors of a survey are correlated
over such distances. What only one of the clouds could see says nothing.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.registration.similarity import Similarity, Surface
from executive_plugins.registration.site_view import SiteView

from executive.arrays import Float
from executive.geometry.pose import pose

CAP = 4.5  # largest cost of an observation, that of a residual of three standard deviations
_PATCH_M = 0.30  # edge of a patch of a stone whose points are one observation
_PER_SQUARE = 0.25  # observations a square metre of ground: its waves are some metres long
_LEAST_STD_M = 0.02  # of residuals: surveys are bent by a centimetre or two over some metres
_MOST_RELIEF_STD_M = 0.03  # the ground tells motions apart only if it fits under the best one
_FREE_SHARE = 0.5  # of the cells under a stone that must show plain ground to speak against it
Pairs = tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True, eq=False)
class StoneFit:
    """How the stones that a motion brings together fit.

    Attributes:
        near: Pairs (source, target) of stones near each other.
        agreeing: Those whose surfaces agree.
        costs: Mean cost of an observation of each pair near, shape (K,).
        weights: Observations of each, shape (K,).
    """

    near: Pairs
    agreeing: Pairs
    costs: Float
    weights: Float

    @property
    def mean_cost(self) -> float:
        """The mean cost of an observation; the largest cost if there is none."""
        return float(self.costs @ self.weights / self.weights.sum()) if len(self.costs) else CAP

    def excess(self, usual: float) -> float:
        """Return by how much the observations cost more than is usual, in sum."""
        return float(((self.costs - usual) * self.weights).sum())


class Evidence:
    """Compares a target and a source under motions."""

    def __init__(
        self, target: SiteView, source: SiteView, truncation_m: float, min_overlap: float
    ) -> None:
        self._target, self._source = target, source
        self._truncation_m = truncation_m
        self._min_overlap = min_overlap
        self._per_point = (target.spacing_m / _PATCH_M) ** 2  # observations

    def count_alike(self, motion: Similarity, pairs: Pairs) -> int:
        """Return how many pairs of segments may agree once the motion is refined to the end.

        Nine tenths of the share are asked for.
        """
        reach_m = self._truncation_m
        shares = [np.isfinite(self._residuals(motion, i, j, reach_m)).mean() for i, j in pairs]
        return sum(share >= 0.9 * self._min_overlap for share in shares)

    def noise_m(self, motion: Similarity, pairs: Pairs) -> float:
        """Return the standard deviation of stones' residuals under the best motion [m]."""
        residuals = [self._residuals(motion, i, j, self._truncation_m) for i, j in pairs]
        return _std(np.concatenate([r[np.isfinite(r)] for r in residuals] or [np.zeros(0)]))

    def stone_fit(self, motion: Similarity, pairs: Pairs, noise_m: float) -> StoneFit:
        """Compare the surfaces of stones that a motion brings near each other."""
        agreeing, costs, weights = [], [], []
        for i, j in pairs:
            residuals = self._residuals(motion, i, j, self._truncation_m)
            if np.isfinite(residuals).mean() >= self._min_overlap:
                agreeing.append((i, j))
            costs.append(float(np.minimum((residuals / noise_m) ** 2 / 2, CAP).mean()))
            weights.append(len(residuals) * self._per_point)
        return StoneFit(pairs, tuple(agreeing), np.array(costs), np.array(weights))

    def contradicted(self, motion: Similarity, pairs: Pairs) -> float:
        """Return the observations of stones that stand where the other cloud shows plain ground.

        Args:
            motion: The motion.
            pairs: Pairs (source, target) of stones near each other, which are left out.
        """
        observations = 0.0
        sides = (
            (self._source.stones, {i for i, _ in pairs}, self._target, motion),
            (self._target.stones, {j for _, j in pairs}, self._source, _inverse(motion)),
        )
        for stones, matched, view, onto in sides:
            for number, stone in enumerate(stones):
                if number not in matched:
                    share = view.share_on_plain_ground(onto.apply(stone.points))
                    is_free = share > _FREE_SHARE
                    observations += is_free * share * len(stone.points) * self._per_point
        return observations

    def relief_excess(self, best: Similarity, other: Similarity) -> tuple[float, float]:
        """Return by how much an observation of the ground costs more under another motion than
        under the best one, and how many observations there are.

        The best motion's residuals give the noise. Nothing counts if the ground does not fit under
        it either, as where it was worked since the survey.
        """
        ours, theirs = (
            self._target.relief_errors(motion.apply(self._source.ground))
            for motion in (best, other)
        )
        std_m = _std(ours)
        if std_m > _MOST_RELIEF_STD_M or not len(ours) or not len(theirs):
            return 0.0, 0.0
        own, rival = (
            float(np.minimum((errors / std_m) ** 2 / 2, CAP).mean()) for errors in (ours, theirs)
        )
        return rival - own, len(theirs) * _PER_SQUARE

    def _residuals(self, motion: Similarity, i: int, j: int, reach_m: float) -> Float:
        """Return distances of one stone's points from the other's surface [m], inf if not near.

        Of both directions that with more near points: a view from one side lies on a whole stone.
        """
        here, there = self._source.stones[i], self._target.stones[j]
        ways = (
            _heights(there, motion.apply(here.points), reach_m),
            _heights(here, _inverse(motion).apply(there.points), reach_m),
        )
        return max(ways, key=lambda way: float(np.isfinite(way).mean()))


def _heights(surface: Surface, points: Float, reach_m: float) -> Float:
    distances, rows = surface.nearest(points, reach_m)
    near = np.isfinite(distances)
    offsets = points[near] - surface.points[rows[near]]
    heights = np.full(len(points), np.inf)
    heights[near] = np.einsum("ij,ij->i", offsets, surface.normals[rows[near]])
    return heights


def _inverse(motion: Similarity) -> Similarity:
    R, t = motion.T_target_source[:3, :3], motion.T_target_source[:3, 3]
    return Similarity(pose(R.T, -R.T @ t / motion.scale), 1 / motion.scale)


def _std(residuals: Float) -> float:
    """Return the standard deviation about zero [m], by the median; a few strange ones do not
    count.
    """
    robust = 1.4826 * float(np.median(np.abs(residuals))) if len(residuals) else 0.0
    return max(robust, _LEAST_STD_M)
