"""A target and a source, segmented and prepared for the test of many motions."""

from collections.abc import Sequence

import numpy as np
from executive_plugins.registration.centroid_matching import matched_centroids
from executive_plugins.registration.evidence import Evidence
from executive_plugins.registration.settings import SegmentSettings
from executive_plugins.registration.similarity import Similarity, Surface

from executive.arrays import Float
from executive.messages.segment import Segment, Segmentation

_ELSEWHERE_M = 0.3  # a motion is another one if it moves some stone's centroid this far


class Matchup:
    """What is known of both clouds before a motion is tried.

    Attributes:
        settings: Of the registration.
        target, source: The clouds, segmented.
        stones: The surface of all target segments together.
        evidence: Compares both under a motion.
    """

    def __init__(
        self, settings: SegmentSettings, target: Segmentation, source: Segmentation
    ) -> None:
        self.settings, self.target, self.source = settings, target, source
        self.stones = Surface.thinned(joined(target.segments), settings.fine_voxel_m)
        self.evidence = Evidence(target, source, settings.truncation_m, settings.min_overlap)

    def matched(self, motion: Similarity) -> tuple[tuple[int, int], ...]:
        """Return pairs (source, target) of segments whose centroids a motion brings together."""
        moved = motion.apply(centroids(self.source.segments))
        return matched_centroids(centroids(self.target.segments), moved, self.settings.max_match_m)

    def is_same(self, one: Similarity, other: Similarity) -> bool:
        """Return whether two motions lay all stones at nearly the same places."""
        middles = centroids(self.source.segments)
        apart = one.apply(middles) - other.apply(middles)
        return bool(np.linalg.norm(apart, axis=1).max() < _ELSEWHERE_M)


def centroids(segments: Sequence[Segment]) -> Float:
    """Return the centroids of segments [m], shape (N, 3)."""
    return np.array([segment.centroid for segment in segments]).reshape(-1, 3)


def joined(segments: Sequence[Segment]) -> Float:
    """Return the points of all segments [m], shape (N, 3)."""
    return np.vstack([segment.points for segment in segments])
