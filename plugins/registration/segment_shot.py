"""Registration on segments whose motions come from where the segments stand and, where these are
refused, from SHOT descriptors.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.registration.consistency import consistent_transforms
from executive_plugins.registration.constellation import Constellation
from executive_plugins.registration.motion_proposer import MotionProposer
from executive_plugins.registration.segment_registrar import SegmentRegistrar
from executive_plugins.registration.settings import SegmentShotSettings
from executive_plugins.registration.shot_features import (
    describe_keypoints,
    find_keypoints,
    match_descriptors,
)
from executive_plugins.registration.stopwatch import Stopwatch

from executive.arrays import Float
from executive.interfaces.alignment import Aligner
from executive.interfaces.segmentation import Segmenter
from executive.messages.segment import Segment, Segmentation


@dataclass(frozen=True, slots=True)
class Shot(MotionProposer):
    """Propose from groups of consistent SHOT matches (steps 2 to 4)."""

    settings: SegmentShotSettings

    def propose(self, target: Segmentation, source: Segmentation, watch: Stopwatch) -> list[Float]:
        """Return the motions that most matches vote for; see `MotionProposer.propose`."""
        s = self.settings
        with watch.stage("keypoints"):
            there, here = (
                [
                    find_keypoints(one, s.feature_voxel_m, s.iss_radius_m, s.keypoint_gap_m)
                    for one in x.segments
                ]
                for x in (target, source)
            )
        with watch.stage("description"):
            features = (
                describe_keypoints(there, s.shot_radius_m),
                describe_keypoints(here, s.shot_radius_m),
            )
        with watch.stage("matching"):
            matched = match_descriptors(*features, s.max_matches)
        with watch.stage("verification"):
            return [
                *consistent_transforms(*matched, s.consistency_m, s.max_scale_error, s.candidates)
            ]


class SegmentShot(SegmentRegistrar):
    """Registration by segments: the arrangement of their centroids first, ISS and SHOT where its
    motion is refused, at the same gate.

    Deviation from the paper, whose motions come from descriptors alone: describing the keypoints
    takes a quarter of the time, and the arrangement finds the motion in nearly all sites.
    """

    Settings = SegmentShotSettings

    def __init__(
        self, settings: SegmentShotSettings, segmentation: Segmenter, alignment: Aligner
    ) -> None:
        super().__init__(settings, segmentation, alignment)
        first = (Constellation(settings),) if settings.falls_back else ()
        self._tried: tuple[MotionProposer, ...] = (*first, Shot(settings))

    def start(self) -> None:
        """Compile the inner loops, so that no registration has to wait for them."""
        super().start()
        points = np.mgrid[0:4, 0:4, 0:4].reshape(3, -1).T * 0.1
        found = find_keypoints(Segment(0, points, points.mean(axis=0), np.ones(3)), 0.05, 0.2, 0.1)
        describe_keypoints([found], 0.4)

    def _proposers(self) -> tuple[MotionProposer, ...]:
        return self._tried
