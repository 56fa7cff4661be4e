"""Object-like parts of a cloud, and what else rises from its ground."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from executive.arrays import Float, checked
from executive.messages.cloud import Cloud


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """Points of one object on the ground (Mascaro 2020, Sec. 4.3).

    Attributes:
        id: Number within its segmentation, 0 for the one of most points.
        points: Points of the object in the frame of the segmented cloud [m], shape (N, 3).
        centroid: Mean of the points [m], shape (3,).
        extents: Side lengths of the box along the principal axes, longest first [m], shape (3,).
        foot: Points of its foot, too low to be told from the ground by their height alone; they
            are in the segmentation's ground, too [m], shape (F, 3).
    """

    id: int
    points: Float
    centroid: Float
    extents: Float
    foot: Float = field(default_factory=lambda: np.zeros((0, 3)))

    def with_foot(self) -> "Segment":
        """Return the segment with its foot among its points; the extents stay those without it."""
        points = np.concatenate([self.points, self.foot])
        return Segment(self.id, points, points.mean(axis=0), self.extents)

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", checked("points", self.points, None, 3))
        object.__setattr__(self, "foot", checked("foot", self.foot, None, 3))
        object.__setattr__(self, "centroid", checked("centroid", self.centroid, 3))
        object.__setattr__(self, "extents", checked("extents", self.extents, 3))


class PartKind(StrEnum):
    """What a part that rises from the ground is taken for, if it is no stone."""

    STACK = "stack"  # several stones that touch or lie on each other, and could not be parted
    TOO_LARGE = "too_large"
    TOO_SMALL = "too_small"
    STRUCTURE = "structure"  # flat, or wider than any heap: a wall, a building, a slope
    MOVING = "moving"  # it came a moment ago or is leaving; one cloud alone does not show that
    FAR = "far"  # farther away than stones are looked for
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True, eq=False)
class LeftOut:
    """A part that rises from the ground and is no segment.

    Attributes:
        kind: What it is taken for.
        reason: What it was measured to be, and the limit.
        points: Number of its points.
        centroid: Mean of the points [m], shape (3,).
        extents: Side lengths of the box along the principal axes, longest first [m], shape (3,).
        surface: Its points in the frame of the segmented cloud [m], shape (N, 3); none where the
            method does not tell them.
    """

    kind: PartKind
    reason: str
    points: int
    centroid: Float
    extents: Float
    surface: Float = field(default_factory=lambda: np.zeros((0, 3)))

    def __post_init__(self) -> None:
        object.__setattr__(self, "surface", checked("surface", self.surface, None, 3))
        object.__setattr__(self, "centroid", checked("centroid", self.centroid, 3))
        object.__setattr__(self, "extents", checked("extents", self.extents, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Segmentation:
    """A cloud split into its ground and the objects on it.

    Attributes:
        frame: Frame of all coordinates.
        segments: Object-like parts, the one of most points first.
        ground: Points classified as ground.
        ground_plane: Unit normal n (pointing up) and offset d with n·p = d [m], shape (4,).
        left_out: Parts that rise from the ground and are no segment, the one of most points first.
        scattered_points: Points above the ground in clusters too small to be named.
        warnings: What speaks against the cloud being a site in metres with z up.
    """

    frame: str
    segments: tuple[Segment, ...]
    ground: Cloud
    ground_plane: Float
    left_out: tuple[LeftOut, ...] = ()
    scattered_points: int = 0
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "ground_plane", checked("ground_plane", self.ground_plane, 4))

    def leaving_out(self, kind: PartKind, reason_of: Callable[[Float], str]) -> "Segmentation":
        """Return the segmentation with some parts left out as of a kind that it does not know.

        Args:
            kind: The kind, such as what moves.
            reason_of: Says of a part's points [m], shape (N, 3), why it is of that kind; empty if
                it is not.
        """
        found, segments, rest = list[LeftOut](), list[Segment](), list[LeftOut]()
        for one in self.segments:
            if reason := reason_of(one.points):
                what = kind, reason, len(one.points)
                found.append(LeftOut(*what, one.centroid, one.extents, one.points))
            else:
                segments.append(replace(one, id=len(segments)))
        for part in self.left_out:
            reason = reason_of(part.surface) if len(part.surface) else ""
            if reason:
                found.append(replace(part, kind=kind, reason=reason))
            else:
                rest.append(part)
        if not found:
            return self
        left_out = sorted((*found, *rest), key=lambda part: -part.points)
        return replace(self, segments=tuple(segments), left_out=tuple(left_out))
