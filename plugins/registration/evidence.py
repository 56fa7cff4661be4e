"""How likely two clouds of a site are under a motion: stones, free space and ground.

Own addition to the method of the paper, whose gate looks at matched stones only. Each patch of a
stone, and each four square metres of ground, are one observation: errors of a survey are correlated
over such distances. What only one of the clouds could see says nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import islice

import numpy as np
from executive_plugins.registration.laid_stone import LaidStone
from executive_plugins.registration.similarity import Similarity
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

    def count_alike(self, motion: Similarity, pairs: Pairs, enough: int) -> int:
        """Return how many pairs of segments may agree once the motion is refined to the end, or
        how many are enough.

        Nine tenths of the share are asked for.
        """
        shares = (self._laid(motion, i, j).share for i, j in pairs)
        alike = (share for share in shares if share >= 0.9 * self._min_overlap)
        return len(list(islice(alike, enough)))

    def best_fit(self, motion: Similarity, pairs: Pairs, agreeing: Pairs) -> tuple[StoneFit, float]:
        """Return how the stones fit under the best motion, and the standard deviation of the
        residuals of those that agree [m].
        """
        laid = {pair: self._laid(motion, *pair) for pair in pairs}
        near = [stone.heights_m for pair, stone in laid.items() if pair in agreeing]
        noise_m = _std(np.concatenate(near or [np.zeros(0)]))
        return self._fit(laid, noise_m), noise_m

    def stone_fit(self, motion: Similarity, pairs: Pairs, noise_m: float) -> StoneFit:
        """Compare the surfaces of stones that a motion brings near each other.

        A point without a partner is an observation only where the other cloud shows that nothing is
        there: else the other view has not seen that place.
        """
        return self._fit({pair: self._laid(motion, *pair) for pair in pairs}, noise_m)

    def _fit(self, laid: Mapping[tuple[int, int], LaidStone], noise_m: float) -> StoneFit:
        agreeing, costs, weights = [], [], []
        for pair, stone in laid.items():
            if stone.share >= self._min_overlap:
                agreeing.append(pair)
            residuals = stone.residuals_m(self._truncation_m)
            residuals = residuals if len(residuals) else np.full(1, np.inf)
            costs.append(float(np.minimum((residuals / noise_m) ** 2 / 2, CAP).mean()))
            weights.append(len(residuals) * self._per_point)
        return StoneFit(tuple(laid), tuple(agreeing), np.array(costs), np.array(weights))

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

    def surely_contradicted(self, motion: Similarity, pairs: Pairs, reach_m: float) -> float:
        """Return the observations of `contradicted` that no small change of a motion takes away.

        Args:
            motion: The motion.
            pairs: Pairs (source, target) of stones near each other, which are left out.
            reach_m: How far the change moves any point of those stones; others are moved farther,
                as they are farther from the middle of those.
        """
        observations = 0.0
        if not pairs:
            return observations  # nothing holds the motion
        sides = (
            (self._source, [i for i, _ in pairs], self._target, motion),
            (self._target, [j for _, j in pairs], self._source, _inverse(motion)),
        )
        for own, matched, view, onto in sides:
            middles, radii = own.discs
            is_other = np.ones(len(middles), dtype=bool)
            is_other[matched] = False
            others = np.flatnonzero(is_other)
            levers = np.linalg.norm(middles - middles[matched].mean(axis=0), axis=1)
            spread_m = max(float(np.sqrt((levers[matched] ** 2).mean())), own.spacing_m)
            moves_m = reach_m * np.maximum(levers[others] / spread_m, 1.0)
            room_m = view.clearance_m(onto.apply(middles[others]))
            bare = others[room_m > onto.scale * radii[others] + moves_m]
            observations += int(own.sizes[bare].sum()) * self._per_point
        return observations

    def weight(self, pairs: Pairs) -> float:
        """Return the most observations that pairs of stones can be."""
        return self._per_point * sum(
            max(len(self._source.stones[i].points), len(self._target.stones[j].points))
            for i, j in pairs
        )

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

    def _laid(self, motion: Similarity, i: int, j: int) -> LaidStone:
        """Lay one stone's points on the other's surface.

        Of both directions that with more near points: a view from one side lies on a whole stone.
        """
        here, there, reach_m = self._source.stones[i], self._target.stones[j], self._truncation_m
        ways = (
            LaidStone.on(there, self._target, motion.apply(here.points), reach_m),
            LaidStone.on(here, self._source, _inverse(motion).apply(there.points), reach_m),
        )
        return max(ways, key=lambda way: way.share)


def _inverse(motion: Similarity) -> Similarity:
    R, t = motion.T_target_source[:3, :3], motion.T_target_source[:3, 3]
    return Similarity(pose(R.T, -R.T @ t / motion.scale), 1 / motion.scale)


def _std(residuals: Float) -> float:
    """Return the standard deviation about zero [m], by the median; a few strange ones do not
    count.
    """
    robust = 1.4826 * float(np.median(np.abs(residuals))) if len(residuals) else 0.0
    return max(robust, _LEAST_STD_M)
