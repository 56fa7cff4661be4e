"""Global registration on segments: descriptors and constellations propose, surfaces decide."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import small_gicp
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Settings
from executive.errors import DataError
from executive.interfaces.alignment import Aligner
from executive.interfaces.registration import Registrar
from executive.interfaces.segmentation import Segmenter
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation
from plugins.registration.consistency import consistent_transforms
from plugins.registration.constellation import constellation_transforms
from plugins.registration.features import describe, match
from plugins.registration.gate import NOTHING, Agreement, measure
from plugins.registration.similarity import Similarity, Surface, refine
from plugins.registration.stopwatch import Stopwatch
from plugins.registration.vote import matched_centroids


class SegmentFpfhSettings(Settings):
    """Radii of the features, sizes of the search, and the gate."""

    voxel_m: Meters = Field(0.03, gt=0, description="Grid to which the source is thinned, the map's own [m].")
    feature_voxel_m: Meters = Field(0.06, gt=0, description="Grid of the points that shape features [m].")
    iss_radius_m: Meters = Field(0.15, gt=0, description="Salient radius of keypoints, R_iss [m].")
    fpfh_radius_m: Meters = Field(0.50, gt=0, description="Radius of descriptors [m].")
    nearest: int = Field(2, ge=1, le=10, description="Target keypoints that each source keypoint is matched with.")
    consistency_m: Meters = Field(0.08, gt=0, description="Allowed difference of two matches' distances [m].")
    candidates: int = Field(10, ge=1, le=100, description="Most motions of each origin that are looked at, b.")
    pair_tolerance_m: Meters = Field(0.5, gt=0, description="Allowed difference of two centroids' distances [m].")
    max_match_m: Meters = Field(1.0, gt=0, description="Largest distance of matched centroids, d_match [m].")
    max_scale_error: float = Field(0.03, ge=0, le=0.2, description="Largest error of the source's scale, as a share.")
    coarse_reach_m: Meters = Field(0.5, gt=0, description="Reach of correspondences at a candidate [m].")
    fine_voxel_m: Meters = Field(0.08, gt=0, description="Grid of the points that refine the motion [m].")
    truncation_m: Meters = Field(0.10, gt=0, description="Distance beyond which points do not overlap [m].")
    max_rmse_m: Meters = Field(0.04, gt=0, description="Largest accepted RMSE of overlapping points [m].")
    min_overlap: float = Field(0.6, ge=0, le=1, description="Smallest accepted share of points that overlap.")
    min_matched: int = Field(3, ge=1, description="Fewest stones that must agree; fewer in view are refused.")


class SegmentFpfh(Registrar):
    """Registration by segments (Mascaro 2020, Sec. 4.4), all six steps but the merging of clouds."""

    Settings = SegmentFpfhSettings
    is_stateless = True
    latency_s = {"register": 1.0}

    def __init__(self, settings: SegmentFpfhSettings, segmentation: Segmenter, alignment: Aligner) -> None:
        self._settings = settings
        self._segmentation = segmentation
        self._alignment = alignment

    def register(self, target: Cloud, source: Cloud, rng: np.random.Generator) -> Alignment:
        """Find the similarity that lays a survey over the map; deterministic, `rng` is not used.

        Returns:
            The motion, accepted or refused. With fewer stones in view than `min_matched` it is refused: two stones
            fit many places.
        """
        watch = Stopwatch()
        with watch.stage("segmentation"):
            try:
                parts = [self._segmentation.segment(cloud) for cloud in (target, self._thinned(source))]
            except DataError as error:
                return _refused(f"a cloud cannot be segmented: {error}", watch)
        return self._lay_over(parts[0], parts[1], watch)

    def _lay_over(self, target: Segmentation, source: Segmentation, watch: Stopwatch) -> Alignment:
        settings = self._settings
        fewest = min(len(target.segments), len(source.segments))
        if fewest < settings.min_matched:
            found = f"target {len(target.segments)}, source {len(source.segments)}"
            return _refused(f"too few stones in view: {found}, need {settings.min_matched}", watch)
        with watch.stage("candidates"):
            candidates = self._candidates(target, source)
        with watch.stage("verification"):
            coarse = self._choose(target, source, candidates)
        if coarse is None:
            return _refused("no motion brings enough stones near each other", watch)
        with watch.stage("refinement"):
            fine = self._refine(target, source, coarse)
        with watch.stage("gate"):
            judged = self._judge(target, source, fine)
        return replace(judged, timings_ms=watch.timings_ms())

    def _thinned(self, source: Cloud) -> Cloud:
        if not len(source):
            return source
        centre = source.points.mean(axis=0)  # the voxel grid has 21 bits an axis
        thin = small_gicp.voxelgrid_sampling(source.points - centre, self._settings.voxel_m, 1)
        return Cloud(source.frame, np.array(thin.points()[:, :3]) + centre)

    def _candidates(self, target: Segmentation, source: Segmentation) -> list[Float]:
        """Propose motions: from groups of consistent matches, then from constellations (steps 2 to 4)."""
        s = self._settings
        features = [describe(x.segments, s.feature_voxel_m, s.iss_radius_m, s.fpfh_radius_m) for x in (target, source)]
        matched = match(features[0], features[1], s.nearest)
        described = consistent_transforms(*matched, s.consistency_m, s.max_scale_error, s.candidates)
        stars = [(_centroids(x.segments), x.ground_plane) for x in (target, source)]
        placed = constellation_transforms(stars[0], stars[1], s.pair_tolerance_m, s.max_match_m, s.candidates)
        return [*described, *placed]

    def _choose(self, target: Segmentation, source: Segmentation, candidates: Sequence[Float]) -> Similarity | None:
        """Refine each candidate a little on the segments, and take the one whose surfaces lie best on each other.

        Deviation from the paper, which takes the one of most matched centroids: those of half-seen stones are off.
        """
        s = self._settings
        surface = Surface(_joined(target.segments), s.fine_voxel_m)
        points = _thin(_joined(source.segments), 2 * s.fine_voxel_m)
        best, best_misfit = None, np.inf
        for T in candidates:
            if len(self._matched(target, source, Similarity(T, 1.0))) < s.min_matched:
                continue
            reaches = (s.coarse_reach_m,) * 3 + (0.6 * s.coarse_reach_m,) * 3
            fitted = refine(surface, points, Similarity(T, 1.0), reaches, 0.0)
            distances, _ = surface.nearest(fitted.apply(points), 2 * s.truncation_m)
            misfit = float(np.minimum(distances, 2 * s.truncation_m).mean())
            if misfit < best_misfit:
                best, best_misfit = fitted, misfit
        return best

    def _matched(self, target: Segmentation, source: Segmentation, motion: Similarity) -> tuple[tuple[int, int], ...]:
        moved = motion.apply(_centroids(source.segments))
        return matched_centroids(_centroids(target.segments), moved, self._settings.max_match_m)

    def _refine(self, target: Segmentation, source: Segmentation, coarse: Similarity) -> Similarity:
        """Align the segments (step 5), then the whole clouds with their scale."""
        s = self._settings
        parts = [Cloud(x.frame, _joined(x.segments)) for x in (target, source)]
        aligned = self._alignment.align(parts[0], parts[1], coarse.T_target_source, 0.6 * s.coarse_reach_m)
        start = Similarity(aligned.T_target_source, 1.0) if aligned.accepted else coarse
        surface = Surface(_whole(target), s.fine_voxel_m)
        reaches = tuple(s.truncation_m * factor for factor in (3, 3, 2, 2, 1.5, 1.5, 1, 1))
        return refine(surface, _thin(_whole(source), s.fine_voxel_m), start, reaches, s.max_scale_error)

    def _judge(self, target: Segmentation, source: Segmentation, fine: Similarity) -> Alignment:
        """Pass the gate on the segments whose centroids have been matched (step 5)."""
        s = self._settings
        pairs = self._matched(target, source, fine)
        agreements = {
            (i, j): measure(target.segments[j].points, fine.apply(source.segments[i].points), s.truncation_m, s.voxel_m)
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


def _refused(reason: str, watch: Stopwatch) -> Alignment:
    return Alignment(np.eye(4), False, reason, 0.0, 0.0, timings_ms=watch.timings_ms())


def _centroids(segments: Sequence[Segment]) -> Float:
    return np.array([segment.centroid for segment in segments]).reshape(-1, 3)


def _joined(segments: Sequence[Segment]) -> Float:
    return np.vstack([segment.points for segment in segments])


def _whole(segmentation: Segmentation) -> Float:
    return np.vstack([segmentation.ground.points, _joined(segmentation.segments)])


def _thin(points: Float, voxel_m: float) -> Float:
    return np.array(small_gicp.voxelgrid_sampling(points, voxel_m, 1).points()[:, :3])
