"""One known object found again in a cloud, however it lies there.

Maps are registered on several stones, for two fit many places. One stone whose whole surface is
known is enough if what is seen of it lies on that surface in one way only, and above the ground.
Own addition to the method of the paper, whose realignment (Sec. 4.5) ends where the basin of ICP
ends.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.registration.form import form_error
from executive_plugins.registration.gate import Agreement, measure, refusal
from executive_plugins.registration.motion_proposer import MotionProposer
from executive_plugins.registration.settings import SegmentSettings
from executive_plugins.registration.similarity import Similarity, Surface, refine
from executive_plugins.registration.stopwatch import Stopwatch
from executive_plugins.registration.thinning import thinned

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import angle_between, from_quaternion
from executive.interfaces.segmentation import Segmenter
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation

_SIZES = (0.35, 1.2)  # of a view's diagonal to the model's
_TURNS = 240  # rotations to begin with: none is farther than some 30° from one of them
_FINE = 40  # motions, the likeliest, that are refined to the end
_MIN_SHARE = 0.9  # of the view must lie on the model, for the model is all that may be seen there
# of both surfaces: right stones came to 8 mm at most, others that pass the rest to 15 and more
_MAX_FORM_M = 0.011
_MIN_COVERAGE = 0.3  # of the model must be seen: a small patch fits anywhere
_SUNK_M, _MAX_SUNK = (
    0.15,
    0.05,
)  # depth under the ground, and the share of the model that may be deeper
_OTHER_RAD = 0.35  # motions that turn differently by this are two answers
_RIVAL = 1.25  # least misfit of a second answer, in that of the best


@dataclass(frozen=True, slots=True, eq=False)
class _Answer:
    """A motion of the model into the target, and how far the view is from it on average [m]."""

    T_target_model: Float
    misfit_m: float
    view: Float


class ObjectFinder:
    """Finds a model in a target by what rises from the ground there."""

    def __init__(
        self,
        settings: SegmentSettings,
        segmentation: Segmenter,
        proposers: Sequence[MotionProposer],
    ) -> None:
        self._settings = settings
        self._segmentation = segmentation
        self._proposers = proposers

    def find(self, target: Cloud, model: Cloud) -> Alignment:
        """Try motions that features propose, then turns all around; the same gate decides."""
        watch = Stopwatch()
        if not len(model) or not np.ptp(model.points, axis=0).any():
            return refusal("the object's model has no extent", watch)
        with watch.stage("segmentation"):
            try:
                seen = self._segmentation.segment(target)
            except DataError as error:
                return refusal(f"the cloud cannot be segmented: {error}", watch)
        views = [segment for segment in seen.segments if self._is_like(segment, model)]
        if not views:
            return refusal(
                f"nothing of the object's size among {len(seen.segments)} that rise "
                "from the ground",
                watch,
            )
        refused = refusal("no motion was proposed", watch)
        for origin in (self._by_features, _all_around):
            with watch.stage("verification"):
                answers = self._answers(
                    model, ((view, origin(seen, view, model)) for view in views)
                )
            if answers:
                found = self._judge(seen, model, answers, watch)
                if found.accepted:
                    return found
                refused = found
        return refused

    def _is_like(self, segment: Segment, model: Cloud) -> bool:
        ratio = np.linalg.norm(np.ptp(segment.points, axis=0)) / np.linalg.norm(
            np.ptp(model.points, axis=0)
        )
        return bool(_SIZES[0] <= ratio <= _SIZES[1])

    def _by_features(self, seen: Segmentation, view: Segment, model: Cloud) -> Iterable[Float]:
        there = Segmentation(seen.frame, (view,), seen.ground, seen.ground_plane)
        whole = Segment(0, model.points, model.points.mean(axis=0), view.extents)
        here = Segmentation(
            model.frame, (whole,), Cloud(model.frame, np.empty((0, 3))), seen.ground_plane
        )
        return self._proposers[0].propose(there, here, Stopwatch())

    def _answers(
        self, model: Cloud, proposals: Iterable[tuple[Segment, Iterable[Float]]]
    ) -> list[_Answer]:
        """Refine each proposal on the model's surface, on which all of a view lies;
        the best first.
        """
        s, coarse = self._settings, list[_Answer]()
        surface = Surface.thinned(model.points, s.fine_voxel_m / 2)
        for view, motions in proposals:
            few = thinned(view.points, 2 * s.fine_voxel_m)
            coarse += [
                self._refined(surface, few, T, view.points, (s.coarse_reach_m,) * 4)
                for T in motions
            ]
        coarse.sort(key=lambda answer: answer.misfit_m)
        reaches = (0.5 * s.coarse_reach_m,) * 4 + (1.5 * s.truncation_m,) * 4
        fine = [
            self._refined(
                surface, thinned(one.view, s.fine_voxel_m), one.T_target_model, one.view, reaches
            )
            for one in coarse[:_FINE]
        ]
        return sorted(fine, key=lambda answer: answer.misfit_m)

    def _refined(
        self,
        surface: Surface,
        points: Float,
        T_target_model: Float,
        view: Float,
        reaches: tuple[float, ...],
    ) -> _Answer:
        limit_m = 2 * self._settings.truncation_m
        fitted = refine(surface, points, Similarity(inverse(T_target_model), 1.0), reaches, 0.0)
        distances, _ = surface.nearest(fitted.apply(points), limit_m)
        return _Answer(
            inverse(fitted.T_target_source), float(np.minimum(distances, limit_m).mean()), view
        )

    def _judge(
        self, seen: Segmentation, model: Cloud, answers: Sequence[_Answer], watch: Stopwatch
    ) -> Alignment:
        s, best = self._settings, answers[0]
        moved = Similarity(best.T_target_model, 1.0).apply(model.points)
        found = measure(best.view, moved, s.truncation_m, s.voxel_m)
        heights = moved @ seen.ground_plane[:3] - seen.ground_plane[3]
        others = [
            a
            for a in answers
            if angle_between(a.T_target_model[:3, :3], best.T_target_model[:3, :3]) > _OTHER_RAD
        ]
        rival = others[0].misfit_m / max(best.misfit_m, 1e-6) if others else np.inf
        surface = Surface.thinned(moved, s.voxel_m / 2)
        form_m = form_error(surface, thinned(best.view, s.voxel_m), s.truncation_m)
        faults = _faults(found, form_m, float((heights < -_SUNK_M).mean()), rival)
        return Alignment(
            T_target_source=best.T_target_model,
            accepted=not faults,
            reason="; ".join(faults) or f"{found}, form {100 * form_m:.1f} cm",
            rmse_m=found.target.rmse_m,
            overlap=found.source.share,
            timings_ms=watch.timings_ms(),
        )


def _faults(found: Agreement, form_m: float, sunk: float, rival: float) -> list[str]:
    """Say what speaks against a motion; `found.target` is how the view lies on the model."""
    faults = []
    if found.target.share < _MIN_SHARE:
        faults.append(
            f"{found.target.share:.2f} of what is seen lies on the object, need {_MIN_SHARE}"
        )
    if found.source.share < _MIN_COVERAGE:
        faults.append(f"{found.source.share:.2f} of the object is seen, need {_MIN_COVERAGE}")
    if form_m > _MAX_FORM_M:
        faults.append(
            f"their forms differ by {100 * form_m:.1f} cm, more than {100 * _MAX_FORM_M:.1f} cm"
        )
    if sunk > _MAX_SUNK:
        faults.append(f"{sunk:.2f} of the object would be under the ground")
    if rival < _RIVAL:
        faults.append(
            f"it may as well lie otherwise: another turn fits {rival:.2f} times as far off"
        )
    return faults


def _all_around(seen: Segmentation, view: Segment, model: Cloud) -> Iterable[Float]:
    """Turn the model about its middle every way, there where the view is."""
    middle = model.points.mean(axis=0)
    for R in _rotations(_TURNS):
        yield pose(R, view.centroid - R @ middle)


def _rotations(count: int) -> Iterable[Float]:
    """Return rotations that are spread evenly (Alexa 2022, super-Fibonacci spirals)."""
    phi, psi = np.sqrt(2.0), 1.533751168755204288118041
    for i in range(count):
        s = i + 0.5
        r, R = np.sqrt(s / count), np.sqrt(1 - s / count)
        a, b = 2 * np.pi * s / phi, 2 * np.pi * s / psi
        yield from_quaternion(
            np.array([r * np.sin(a), r * np.cos(a), R * np.sin(b), R * np.cos(b)])
        )
