"""The best rival of a motion: another one that explains the two clouds nearly as well.

Own addition to the method of the paper. Identical stones at equal distances, or a symmetric site,
can be laid over each other in several ways, and each of them passes a gate on matched stones.
"""

from collections.abc import Sequence

import numpy as np
from executive_plugins.registration.evidence import CAP, StoneFit
from executive_plugins.registration.matchup import Matchup, joined
from executive_plugins.registration.similarity import Similarity, refine
from executive_plugins.registration.thinning import sampled, thinned

from executive.arrays import Float
from executive.messages.alignment import Rival

_LEAST_STONES = 2  # that a rival brings to agreement: one stone fits any other place
_MOST_WEIGHED = 10  # rivals whose likelihood is computed: the misfit alone hardly tells them apart
_MOST_POINTS = 800  # of the source at a candidate; five times as many at a refinement
_MOST_GROUND = 13.8  # nats, a factor of 10⁶: ground is worked, and never decides alone
_MOST_LOG_RATIO = 100.0  # a larger one is told as this
_PROMISING = 3.0  # mean cost of an observation up to which a rival is refined to the end


class RivalSearch:
    """Looks for rivals among motions that were proposed.

    Attributes:
        limit: Largest likelihood of a rival, in that of the best motion, that is no doubt.
        excluded: Motions that stones on plain ground excluded before they were refined.
    """

    def __init__(self, clouds: Matchup, hypotheses: int) -> None:
        """Prepare the search.

        All motions are equally likely before the clouds are looked at, so that the probability that
        another one is true is at most their number times the largest ratio of likelihoods.

        Args:
            clouds: Both clouds.
            hypotheses: Number of motions that were tried.
        """
        self._settings, self._clouds = clouds.settings, clouds
        self.limit = clouds.settings.max_wrong_probability / max(hypotheses, 1)
        self.excluded, self._for_best = 0, 0.0
        self._narrow_m = tuple(x * clouds.settings.truncation_m for x in (3, 2, 1.5, 1, 1))
        self._edge_m = 3 * clouds.settings.fine_voxel_m
        self._few = dict[int, Float]()

    def best_rival(
        self, best: Similarity, agreeing: tuple[tuple[int, int], ...], candidates: Sequence[Float]
    ) -> Rival | None:
        """Return the likeliest of the candidates that lay stones elsewhere than the best motion.

        Args:
            best: The motion that was accepted.
            agreeing: Pairs (source, target) of segments that agree under it.
            candidates: T_target_source of motions, each (4, 4).

        Returns:
            The rival; None if no candidate brings two stones to agreement elsewhere.
        """
        evidence, found = self._clouds.evidence, None
        own, noise_m = evidence.best_fit(best, self._clouds.matched(best), agreeing)
        self._for_best = evidence.contradicted(best, own.near)
        for motion in self._rough(best, candidates, own.mean_cost):
            near = self._clouds.matched(motion)
            if self._is_excluded(motion, near, own.mean_cost, self._narrow_m[0]):
                self.excluded += 1
                continue
            fit = evidence.stone_fit(motion, near, noise_m)
            if fit.mean_cost < _PROMISING:  # else some centimetres more change nothing
                motion = self._refined(motion, fit.near)
                fit = evidence.stone_fit(motion, self._clouds.matched(motion), noise_m)
            if len(fit.agreeing) < _LEAST_STONES or self._clouds.is_same(motion, best):
                continue
            ratio = self._ratio(motion, fit, best, own)
            if found is None or ratio > found.likelihood_ratio:
                found = Rival(motion.T_target_source, motion.scale, ratio, fit.agreeing)
        return found

    def _is_excluded(
        self, motion: Similarity, near: Sequence[tuple[int, int]], usual: float, reach_m: float
    ) -> bool:
        """Return whether stones on plain ground alone keep a motion below the limit, however well
        the stones near each other fit, and wherever within a reach the refinement ends.
        """
        evidence = self._clouds.evidence
        against = evidence.surely_contradicted(motion, tuple(near), reach_m) - self._for_best
        most = usual * evidence.weight(tuple(near)) - against * (CAP - usual)
        return _ratio_of(most) <= self.limit

    def _ratio(self, motion: Similarity, fit: StoneFit, best: Similarity, own: StoneFit) -> float:
        """Return the likelihood of a motion in that of the best.

        What is costly is looked at only if the stones have not decided; then free space, then the
        ground. Observations that only the best motion makes do not count for it.
        """
        evidence, limit = self._clouds.evidence, self.limit
        usual = own.mean_cost
        logarithm = -fit.excess(usual)
        if _ratio_of(logarithm) > limit:
            against = evidence.contradicted(motion, fit.near) - self._for_best
            logarithm -= against * (CAP - usual)
        if _ratio_of(logarithm) > limit:
            excess, count = evidence.relief_excess(best, self._on_ground(motion, fit.near))
            logarithm -= min(excess * count, _MOST_GROUND)
        return _ratio_of(logarithm)

    def _on_ground(self, motion: Similarity, near: Sequence[tuple[int, int]]) -> Similarity:
        """Refine a motion on stones and ground, as the best one was."""
        s, clouds = self._settings, self._clouds
        stones = thinned(joined([clouds.source.segments[i] for i, _ in near]), s.fine_voxel_m)
        parts = (sampled(part, 5 * _MOST_POINTS) for part in (stones, clouds.ground_points))
        return refine(
            clouds.surface, np.vstack([*parts]), motion, self._narrow_m, s.max_scale_error
        )

    def _rough(
        self, best: Similarity, candidates: Sequence[Float], usual: float
    ) -> list[Similarity]:
        """Refine candidates roughly; return those that fit best, without the best's own basin."""
        s, limit_m = self._settings, 2 * self._settings.truncation_m
        wide = (s.coarse_reach_m, s.coarse_reach_m, 0.6 * s.coarse_reach_m)
        found: list[tuple[float, Similarity]] = []
        known = [best]
        for T in candidates:
            start = Similarity(T, best.scale)
            near = self._clouds.matched(start)
            if len(near) < _LEAST_STONES or self._is_any(start, known):
                continue
            if self._is_excluded(start, near, usual, s.coarse_reach_m):
                self.excluded += 1
                continue
            points = sampled(np.vstack([self._few_of(i) for i, _ in near]), _MOST_POINTS)
            fitted = refine(self._clouds.stones, points, start, wide, 0.0)
            if not self._is_any(fitted, known):
                known.append(fitted)
                distances, _ = self._clouds.stones.nearest(fitted.apply(points), limit_m)
                found.append((float(np.minimum(distances, limit_m).mean()), fitted))
        found.sort(key=lambda one: one[0])
        return [motion for _, motion in found[:_MOST_WEIGHED]]

    def _few_of(self, stone: int) -> Float:
        if stone not in self._few:
            self._few[stone] = thinned(self._clouds.source.segments[stone].points, self._edge_m)
        return self._few[stone]

    def _refined(self, motion: Similarity, near: Sequence[tuple[int, int]]) -> Similarity:
        """Refine a rival with its scale, as the best one was: else it pays for a wrong scale."""
        s = self._settings
        stones = joined([self._clouds.source.segments[i] for i, _ in near])
        points = sampled(thinned(stones, s.fine_voxel_m), 5 * _MOST_POINTS)
        return refine(self._clouds.stones, points, motion, self._narrow_m, s.max_scale_error)

    def _is_any(self, motion: Similarity, others: Sequence[Similarity]) -> bool:
        return any(self._clouds.is_same(motion, other) for other in others)


def _ratio_of(logarithm: float) -> float:
    return float(np.exp(min(logarithm, _MOST_LOG_RATIO)))
