"""Global registration on segments: test the proposed motions, refine the best, accept or refuse."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from executive_plugins.registration.constellation import Constellation
from executive_plugins.registration.gate import refusal
from executive_plugins.registration.matchup import Matchup
from executive_plugins.registration.motion_proposer import MotionProposer
from executive_plugins.registration.settings import SegmentSettings
from executive_plugins.registration.similarity import (
    Similarity,
    Surface,
    compile_refinement,
    refine,
)
from executive_plugins.registration.single_object import ObjectFinder
from executive_plugins.registration.site_view import compile_site_view
from executive_plugins.registration.stopwatch import Stopwatch
from executive_plugins.registration.thinning import (
    compile_thinning,
    less,
    mean_point,
    sampled,
    thinned,
)
from executive_plugins.registration.uncertainty import motion_uncertainty
from executive_plugins.registration.verdict import against_rivals, judge

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.interfaces.alignment import Aligner
from executive.interfaces.registration import Registrar
from executive.interfaces.segmentation import Segmenter
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.segment import Segmentation

# A misfit below this share of the truncation needs no rival. In 20 scenes 95 right candidates had
# 0.7 to 1.1, 234 wrong ones 1.5 and more; a wrong one below is left to the gate.
_CLEAR = 1.2
# So that a verdict takes bounded time: points of the source at a candidate, and of its stones and
# its ground in a refinement (noise of some centimetres then leaves below a millimetre of the
# motion, a tenth of what the bends of a survey leave); and stones of either cloud beyond which the
# arrangement alone has to propose the motions.
_MOST_COARSE, _MOST_FINE, _MOST_DESCRIBED = 800, 2_000, 40


class SegmentRegistrar(Registrar):
    """Registration by segments (Mascaro 2020, Sec. 4.4), all six steps but the merging
    of clouds.
    """

    Settings = SegmentSettings
    is_stateless = True
    latency_s = {"register": 1.0, "find": 1.0}

    def __init__(
        self, settings: SegmentSettings, segmentation: Segmenter, alignment: Aligner
    ) -> None:
        self._settings = settings
        self._segmentation = segmentation
        self._alignment = alignment

    def start(self) -> None:
        """Compile the inner loops, so that no registration has to wait for them."""
        Constellation.compile()
        compile_refinement()
        compile_site_view()
        compile_thinning()

    @abstractmethod
    def _proposers(self) -> tuple[MotionProposer, ...]:
        """Return the methods that propose motions, in the order in which they are tried."""

    def register(self, target: Cloud, source: Cloud, rng: np.random.Generator) -> Alignment:
        """Find the similarity from a survey to the map; deterministic, `rng` is not used.

        Computations use coordinates relative to each cloud's mean, so that large national
        coordinates lose no precision.

        Returns:
            The motion, accepted or refused. With fewer stones in view than `min_matched` it is
            refused: two stones fit many places. It is refused, too, where another motion explains
            both clouds nearly as well. If several proposers are refused, the first one's
            answer is returned.
        """
        watch = Stopwatch()
        middle_t, middle_s = _middle(target), _middle(source)
        with watch.stage("segmentation"):
            thin = self._thinned(source, middle_s)  # first, as it takes the most memory
            try:
                there = self._segmentation.segment(
                    Cloud(target.frame, less(target.points, middle_t))
                )
                here = self._segmentation.segment(thin)
            except DataError as error:
                return refusal(f"a cloud cannot be segmented: {error}", watch)
        found = self._lay_over(there, here, watch)

        def placed(T: Float, scale: float) -> Float:
            R, t = T[:3, :3], T[:3, 3]
            return pose(R, t + middle_t - scale * R @ middle_s)

        rival, doubt = found.rival, found.uncertainty
        if rival is not None:
            rival = replace(rival, T_target_source=placed(rival.T_target_source, rival.scale))
        if doubt is not None:
            doubt = replace(doubt, centre=doubt.centre + middle_t)
        return replace(
            found,
            T_target_source=placed(found.T_target_source, found.scale),
            rival=rival,
            uncertainty=doubt,
            timings_ms=watch.timings_ms(),
        )

    def find(self, target: Cloud, model: Cloud) -> Alignment:
        """Find one object in any pose; see `single_object`."""
        return ObjectFinder(self._settings, self._segmentation, self._proposers()).find(
            target, model
        )

    def _lay_over(self, target: Segmentation, source: Segmentation, watch: Stopwatch) -> Alignment:
        few = self._too_few(target, source)
        if few:
            is_final = (
                len(source.segments) < self._settings.min_matched
            )  # the survey stays as it is
            return replace(refusal(few, watch), is_final=is_final)
        with watch.stage("verification"):
            clouds = Matchup(self._settings, target, source)
        placed = Constellation(self._settings).propose(target, source, watch)
        refusals, tried = list[Alignment](), list[Similarity]()
        proposers = self._proposers()
        if max(len(target.segments), len(source.segments)) > _MOST_DESCRIBED:
            proposers = (Constellation(self._settings),)
        for proposer in proposers:
            candidates = (
                placed
                if isinstance(proposer, Constellation)
                else proposer.propose(target, source, watch)
            )
            attempt = self._attempt(clouds, candidates, tried, watch)
            if attempt.accepted:
                others = placed if candidates is placed else [*placed, *candidates]
                with watch.stage("rivals"):
                    return against_rivals(clouds, attempt, others)
            refusals.append(attempt)
        return refusals[0]

    def _too_few(self, target: Segmentation, source: Segmentation) -> str:
        """Say that there are too few stones; nothing if there are enough."""
        counts, need = (len(target.segments), len(source.segments)), self._settings.min_matched
        if min(counts) >= need:
            return ""
        found = f"target {counts[0]}, source {counts[1]}"
        return f"too few stones in view: {found}, need {need}"

    def _attempt(
        self,
        clouds: Matchup,
        candidates: Sequence[Float],
        tried: list[Similarity],
        watch: Stopwatch,
    ) -> Alignment:
        with watch.stage("verification"):
            coarse = self._choose(clouds, candidates)
            if coarse is None:
                return refusal("no motion brings enough stones near each other", watch)
            if any(clouds.is_same(coarse, other) for other in tried):
                return refusal("no other motion than the one refused before", watch)
            settled = self._settle(clouds, coarse)
            need, pairs = self._settings.min_matched, clouds.matched(settled)
            alike = clouds.evidence.count_alike(settled, pairs, need)
        if alike < need:
            told = f"{alike} stones agree roughly under the best motion, need {need}"
            return refusal(told, watch)
        tried.append(coarse)
        with watch.stage("refinement"):
            surface, points, fine = self._refine(clouds, settled)
        with watch.stage("gate"):
            found = judge(clouds, fine)
            if not found.accepted:
                return found
            s = self._settings
            doubt = motion_uncertainty(surface, points, fine, s.truncation_m, s.bend_m)
            return replace(found, uncertainty=doubt)

    def _thinned(self, source: Cloud, middle: Float) -> Cloud:
        if not len(source):
            return source
        return Cloud(source.frame, thinned(less(source.points, middle), self._settings.voxel_m))

    def _choose(self, clouds: Matchup, candidates: Sequence[Float]) -> Similarity | None:
        """Refine candidates a little on the segments, and return the one with the best surface fit.

        Deviation from the paper, which takes the candidate with most matched centroids: those of
        stones seen from one side are off. Here, their number only gives the order in which
        candidates are tried, and the first clear fit ends the search.
        """
        s = self._settings
        points = sampled(thinned(clouds.stone_points, 2 * s.fine_voxel_m), _MOST_COARSE)
        votes = [len(clouds.matched(Similarity(T, 1.0))) for T in candidates]
        best, best_misfit = None, np.inf
        for i in sorted(range(len(candidates)), key=lambda i: -votes[i]):
            if votes[i] < s.min_matched or best_misfit < _CLEAR * s.truncation_m:
                break
            reaches = (s.coarse_reach_m,) * 3 + (0.6 * s.coarse_reach_m,) * 3
            fitted = refine(clouds.stones, points, Similarity(candidates[i], 1.0), reaches, 0.0)
            distances, _ = clouds.stones.nearest(fitted.apply(points), 2 * s.truncation_m)
            misfit = float(np.minimum(distances, 2 * s.truncation_m).mean())
            if misfit < best_misfit:
                best, best_misfit = fitted, misfit
        return best

    def _settle(self, clouds: Matchup, coarse: Similarity) -> Similarity:
        """Refine a candidate on few points of the stones, with its scale: enough for a verdict on
        most wrong ones, before the costly refinement.
        """
        s = self._settings
        points = sampled(clouds.stone_points, _MOST_COARSE)
        reaches = tuple(s.truncation_m * factor for factor in (3, 3, 2))
        return refine(clouds.stones, points, coarse, reaches, s.max_scale_error)

    def _refine(self, clouds: Matchup, start: Similarity) -> tuple[Surface, Float, Similarity]:
        """Align the segments (step 5), then the whole clouds with their scale.

        The ground, which determines the level of the motion, is smooth and so thinned more.

        Returns:
            The target's surface, the source's points, and the motion between them.
        """
        s, target, source = self._settings, clouds.target, clouds.source
        moving = sampled(clouds.stone_points, _MOST_FINE)
        few = sampled(moving, _MOST_FINE // 2)
        parts = Cloud(target.frame, clouds.stones.points), Cloud(source.frame, few)
        aligned = self._alignment.align(*parts, start.T_target_source, 0.6 * s.coarse_reach_m)
        if aligned.accepted:
            start = Similarity(aligned.T_target_source, 1.0)
        points = np.vstack([moving, sampled(clouds.ground_points, _MOST_FINE)])
        wide, narrow = (
            tuple(s.truncation_m * factor for factor in steps)
            for steps in ((3, 3, 2, 2), (1.5, 1, 1))
        )
        near = refine(
            clouds.surface, points[::2], start, wide, s.max_scale_error
        )  # half the points find the basin as well
        fine = refine(clouds.surface, points, near, narrow, s.max_scale_error)
        return clouds.surface, points, fine


def _middle(cloud: Cloud) -> Float:
    return mean_point(cloud.points) if len(cloud) else np.zeros(3)
