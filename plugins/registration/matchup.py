"""A target and a source, segmented and prepared for the test of many motions."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from executive_plugins.registration.centroid_matching import matched_centroids
from executive_plugins.registration.evidence import Evidence
from executive_plugins.registration.settings import SegmentSettings
from executive_plugins.registration.similarity import Similarity, Surface
from executive_plugins.registration.site_view import SiteView
from executive_plugins.registration.thinning import sampled, thinned

from executive.arrays import Float
from executive.messages.segment import Segment, Segmentation

_ELSEWHERE_M = 0.3  # a motion is another one if it moves some stone's centroid this far
_MOST_GROUND = 40_000  # points that the ground's surface is made of: 100 in a square metre


class Matchup:
    """What is known of both clouds before a motion is tried.

    Attributes:
        settings: Of the registration.
        target, source: The clouds, segmented.
        middles: Centroids of the target's segments and of the source's [m], each (N, 3).
        stones: The surface of all target segments together.
        evidence: Compares both under a motion.
    """

    def __init__(
        self, settings: SegmentSettings, target: Segmentation, source: Segmentation
    ) -> None:
        self.settings, self.target, self.source = settings, target, source
        self.middles = centroids(target.segments), centroids(source.segments)
        there, here = (SiteView(one, settings.fine_voxel_m) for one in (target, source))
        self.stones = there.stones[0].joined(*there.stones[1:])
        self.evidence = Evidence(there, here, settings.truncation_m, settings.min_overlap)

    @cached_property
    def surface(self) -> Surface:
        """The target's stones and ground as one surface."""
        points = sampled(self.target.ground.points, _MOST_GROUND)
        ground = Surface.thinned(points, self.settings.ground_voxel_m)
        return self.stones.joined(ground)

    @cached_property
    def stone_points(self) -> Float:
        """Points of all source segments, thinned [m], shape (N, 3)."""
        return thinned(joined(self.source.segments), self.settings.fine_voxel_m)

    @cached_property
    def ground_points(self) -> Float:
        """The source's ground, thinned [m], shape (N, 3)."""
        points = sampled(self.source.ground.points, _MOST_GROUND)
        return thinned(points, self.settings.ground_voxel_m)

    def matched(self, motion: Similarity) -> tuple[tuple[int, int], ...]:
        """Return pairs (source, target) of segments whose centroids a motion brings together."""
        there, here = self.middles
        return matched_centroids(there, motion.apply(here), self.settings.max_match_m)

    def is_same(self, one: Similarity, other: Similarity) -> bool:
        """Return whether two motions lay all stones at nearly the same places."""
        here = self.middles[1]
        apart = one.apply(here) - other.apply(here)
        return bool(np.linalg.norm(apart, axis=1).max() < _ELSEWHERE_M)


def centroids(segments: Sequence[Segment]) -> Float:
    """Return the centroids of segments [m], shape (N, 3)."""
    return np.array([segment.centroid for segment in segments]).reshape(-1, 3)


def joined(segments: Sequence[Segment]) -> Float:
    """Return the points of all segments [m], shape (N, 3)."""
    return np.vstack([segment.points for segment in segments])
