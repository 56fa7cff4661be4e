"""Global registration on segments: test the proposed motions, refine the best, accept or refuse."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from executive_plugins.registration.centroid_matching import matched_centroids
from executive_plugins.registration.gate import NOTHING, Agreement, measure, refusal
from executive_plugins.registration.motion_proposer import MotionProposer
from executive_plugins.registration.settings import SegmentSettings
from executive_plugins.registration.similarity import Similarity, Surface, refine
from executive_plugins.registration.single_object import ObjectFinder
from executive_plugins.registration.stopwatch import Stopwatch
from executive_plugins.registration.thinning import thinned

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.interfaces.alignment import Aligner
from executive.interfaces.registration import Registrar
from executive.interfaces.segmentation import Segmenter
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation

# A misfit below this share of the truncation needs no rival. In 20 scenes 95 right candidates had
# 0.7 to 1.1, 234 wrong ones 1.5 and more; a wrong one below is left to the gate.
_CLEAR = 1.2


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

    @abstractmethod
    def _proposers(self) -> tuple[MotionProposer, ...]:
        """Return the methods that propose motions, in the order in which they are tried."""

    def register(self, target: Cloud, source: Cloud, rng: np.random.Generator) -> Alignment:
        """Find the similarity from a survey to the map; deterministic, `rng` is not used.

        Computations use coordinates relative to each cloud's mean, so that large national
        coordinates lose no precision.

        Returns:
            The motion, accepted or refused. With fewer stones in view than `min_matched` it is
            refused: two stones fit many places. If several proposers are refused, the first one's
            answer is returned.
        """
        watch = Stopwatch()
        middle_t, middle_s = _middle(target), _middle(source)
        with watch.stage("segmentation"):
            try:
                there = self._segmentation.segment(Cloud(target.frame, target.points - middle_t))
                here = self._segmentation.segment(self._thinned(source, middle_s))
            except DataError as error:
                return refusal(f"a cloud cannot be segmented: {error}", watch)
        found = self._lay_over(there, here, watch)
        R, t = found.T_target_source[:3, :3], found.T_target_source[:3, 3]
        T = pose(R, t + middle_t - found.scale * R @ middle_s)
        return replace(found, T_target_source=T, timings_ms=watch.timings_ms())

    def find(self, target: Cloud, model: Cloud) -> Alignment:
        """Find one object in any pose; see `single_object`."""
        return ObjectFinder(self._settings, self._segmentation, self._proposers()).find(
            target, model
        )

    def _lay_over(self, target: Segmentation, source: Segmentation, watch: Stopwatch) -> Alignment:
        settings = self._settings
        fewest = min(len(target.segments), len(source.segments))
        if fewest < settings.min_matched:
            found = f"target {len(target.segments)}, source {len(source.segments)}"
            return refusal(f"too few stones in view: {found}, need {settings.min_matched}", watch)
        with watch.stage("verification"):
            stones = Surface.thinned(_joined(target.segments), settings.fine_voxel_m)
        refusals = []
        for proposer in self._proposers():
            attempt = self._attempt(target, source, stones, proposer, watch)
            if attempt.accepted:
                return attempt
            refusals.append(attempt)
        return refusals[0]

    def _attempt(
        self,
        target: Segmentation,
        source: Segmentation,
        stones: Surface,
        proposer: MotionProposer,
        watch: Stopwatch,
    ) -> Alignment:
        candidates = proposer.propose(target, source, watch)
        with watch.stage("verification"):
            coarse = self._choose(target, source, stones, candidates)
        if coarse is None:
            return refusal("no motion brings enough stones near each other", watch)
        with watch.stage("refinement"):
            fine = self._refine(target, source, stones, coarse)
        with watch.stage("gate"):
            return self._judge(target, source, fine)

    def _thinned(self, source: Cloud, middle: Float) -> Cloud:
        if not len(source):
            return source
        return Cloud(source.frame, thinned(source.points - middle, self._settings.voxel_m))

    def _choose(
        self,
        target: Segmentation,
        source: Segmentation,
        stones: Surface,
        candidates: Sequence[Float],
    ) -> Similarity | None:
        """Refine candidates a little on the segments, and return the one with the best surface fit.

        Deviation from the paper, which takes the candidate with most matched centroids: those of
        stones seen from one side are off. Here, their number only gives the order in which
        candidates are tried, and the first clear fit ends the search.
        """
        s = self._settings
        points = thinned(_joined(source.segments), 2 * s.fine_voxel_m)
        votes = [len(self._matched(target, source, Similarity(T, 1.0))) for T in candidates]
        best, best_misfit = None, np.inf
        for i in sorted(range(len(candidates)), key=lambda i: -votes[i]):
            if votes[i] < s.min_matched or best_misfit < _CLEAR * s.truncation_m:
                break
            reaches = (s.coarse_reach_m,) * 3 + (0.6 * s.coarse_reach_m,) * 3
            fitted = refine(stones, points, Similarity(candidates[i], 1.0), reaches, 0.0)
            distances, _ = stones.nearest(fitted.apply(points), 2 * s.truncation_m)
            misfit = float(np.minimum(distances, 2 * s.truncation_m).mean())
            if misfit < best_misfit:
                best, best_misfit = fitted, misfit
        return best

    def _matched(
        self, target: Segmentation, source: Segmentation, motion: Similarity
    ) -> tuple[tuple[int, int], ...]:
        moved = motion.apply(centroids(source.segments))
        return matched_centroids(centroids(target.segments), moved, self._settings.max_match_m)

    def _refine(
        self, target: Segmentation, source: Segmentation, stones: Surface, coarse: Similarity
    ) -> Similarity:
        """Align the segments (step 5), then the whole clouds with their scale.

        The ground, which determines the level of the motion, is smooth and so thinned more.
        """
        s = self._settings
        moving = thinned(_joined(source.segments), s.fine_voxel_m)
        clouds = Cloud(target.frame, stones.points), Cloud(source.frame, moving)
        aligned = self._alignment.align(*clouds, coarse.T_target_source, 0.6 * s.coarse_reach_m)
        start = Similarity(aligned.T_target_source, 1.0) if aligned.accepted else coarse
        surface = stones.joined(Surface.thinned(target.ground.points, s.ground_voxel_m))
        points = np.vstack([moving, thinned(source.ground.points, s.ground_voxel_m)])
        wide, narrow = (
            tuple(s.truncation_m * factor for factor in steps)
            for steps in ((3, 3, 2, 2), (1.5, 1, 1))
        )
        near = refine(
            surface, points[::2], start, wide, s.max_scale_error
        )  # half the points find the basin as well
        return refine(surface, points, near, narrow, s.max_scale_error)

    def _judge(self, target: Segmentation, source: Segmentation, fine: Similarity) -> Alignment:
        """Accept or refuse a motion by the segments whose centroids have been matched (step 5)."""
        s = self._settings
        pairs = self._matched(target, source, fine)
        agreements = {
            (i, j): measure(
                target.segments[j].points,
                fine.apply(source.segments[i].points),
                s.truncation_m,
                s.voxel_m,
            )
            for i, j in pairs
        }
        agreeing = tuple(pair for pair, a in agreements.items() if a.better.share >= s.min_overlap)
        whole = sum(agreements.values(), NOTHING)
        faults = self._faults(whole, len(agreeing))
        reason = "; ".join(faults) or f"{len(agreeing)} stones agree, {whole}"
        return Alignment(
            T_target_source=fine.T_target_source,
            accepted=not faults,
            reason=reason,
            rmse_m=whole.better.rmse_m,
            overlap=whole.source.share,
            matched_segments=agreeing,
            scale=fine.scale,
        )

    def _faults(self, agreement: Agreement, stones: int) -> list[str]:
        s = self._settings
        faults = []
        if stones < s.min_matched:
            faults.append(f"{stones} stones agree, need {s.min_matched}")
        best = agreement.better
        if best.rmse_m > s.max_rmse_m:
            faults.append(f"rmse {best.rmse_m * 100:.1f} cm above {s.max_rmse_m * 100:.1f} cm")
        if best.share < s.min_overlap:
            faults.append(f"overlap {best.share:.2f} below {s.min_overlap}")
        return faults


def centroids(segments: Sequence[Segment]) -> Float:
    """Return the centroids of segments [m], shape (N, 3)."""
    return np.array([segment.centroid for segment in segments]).reshape(-1, 3)


def _middle(cloud: Cloud) -> Float:
    return np.asarray(cloud.points.mean(axis=0)) if len(cloud) else np.zeros(3)


def _joined(segments: Sequence[Segment]) -> Float:
    return np.vstack([segment.points for segment in segments])
