"""What a part that rises from the ground is, if it is no stone, and why."""

from collections.abc import Callable, Sequence

import numpy as np
from executive_plugins.segmentation.hollow import hollow_share, is_hollow
from executive_plugins.segmentation.limits import Limits
from executive_plugins.segmentation.seen_ground import SeenGround
from executive_plugins.segmentation.shape import (
    counts_near,
    moments,
    planes_through,
    principal_extents,
    spans,
)

from executive.arrays import Float, Int
from executive.messages.segment import LeftOut, PartKind

_FLAT_SAMPLE = 500  # points by which a plane is looked for
_BUILT = (PartKind.STRUCTURE, PartKind.TOO_LARGE, PartKind.STACK)
_MOST = 1 / 3  # share of a cluster that is no stone, above which the rest is none either
_UPRIGHT = 2.0  # height in the larger side on the ground: such a stone tips over at 27 degrees
_HANGING = 0.5  # share of a cluster below which ground is seen: what rests on the ground hides it
_WHOLE = 1.5  # hollowness, in that from which parts are looked for, of what has none
Fault = tuple[Float, PartKind, str]  # points of a part that is no stone, what it is, and why
Found = tuple[PartKind, str]


class PartJudge:
    """Tells what a part is.

    Args:
        limits: Sizes of stones.
        most_hollow: Depth of one stone's hollows under its hull, in its longest side.
        flat_margin_m: Distance from a plane that still is the plane [m].
        flat_share: Share of points on one plane above which a part is no stone.
        count_tops: Counts the summits of a part, given places and heights.
        ground: Where the cloud shows ground.
    """

    def __init__(
        self,
        limits: Limits,
        most_hollow: float,
        flat_margin_m: float,
        flat_share: float,
        count_tops: Callable[[Float, Float], int],
        ground: SeenGround,
    ) -> None:
        self._limits, self._most_hollow = limits, most_hollow
        self._flat_margin_m, self._flat_share = flat_margin_m, flat_share
        self._count_tops, self._ground = count_tops, ground

    def fault(
        self, part: Float, places: Float, heights: Float, rng: np.random.Generator
    ) -> Found | None:
        """Return what a part is and why, if it is no stone.

        Args:
            part: Its points [m], shape (N, 3).
            places: Their positions along the ground [m], shape (N, 2).
            heights: Above the ground [m], shape (N,).
            rng: The only source of chance.
        """
        extents = principal_extents(part)
        return (
            self._small(extents, heights)
            or self._flat(part, rng)
            or self._upright(places, heights)
            or self._large(extents, places, heights)
            or self._hollow(part, places, heights, float(extents[0]))
        )

    def wide(self, points: Float) -> Found | None:
        """Return what a cluster is and why, if it is wider than any heap."""
        widest_m = float(spans(points).max())
        if widest_m <= self._limits.heap_m:
            return None
        told = f"{widest_m:.1f} m wide, more than any heap ({self._limits.heap_m:.0f} m)"
        return PartKind.STRUCTURE, told

    def hanging(self, places: Float, heights: Float) -> Found | None:
        """Return what a cluster is if nothing that is hidden can bear it.

        A stone rests on what it hides itself. With ground below most of it, and a gap as high as
        the stone, this would be a stem narrower than half of it and as long as all that is seen.
        """
        lowest_m = float(heights.min())
        if lowest_m <= float(np.ptp(heights)):
            return None
        share = self._ground.share_below(places)
        if share <= _HANGING:
            return None
        told = f"hangs {lowest_m:.2f} m above the ground, which is seen below {share:.0%} of it"
        return PartKind.STRUCTURE, told

    def whole(self, parts: Sequence[Int], faults: Sequence[Found | None]) -> Found | None:
        """Return what a cluster is if a third of it is no stone: the rest is of the same thing.

        Args:
            parts: Rows of the points of each part.
            faults: What each part is, None for a stone.
        """
        sizes = [len(part) for part in parts]
        built = [
            size for size, fault in zip(sizes, faults, strict=True) if fault and fault[0] in _BUILT
        ]
        if len(parts) < 2 or sum(built) <= _MOST * sum(sizes):
            return None
        told = (
            f"{len(built)} of its {len(parts)} parts, {sum(built) / sum(sizes):.0%} of its points"
        )
        return PartKind.STRUCTURE, f"{told}, are flat, upright, too large or stacks"

    def _small(self, extents: Float, heights: Float) -> Found | None:
        least_m, top_m = self._limits.least_height_m, float(heights.max())
        if top_m < least_m:
            return PartKind.TOO_SMALL, f"{top_m:.2f} m high, less than {least_m:.2f} m"
        least_m, longest_m = self._limits.least_extent_m, float(extents[0])
        if longest_m < least_m:
            return PartKind.TOO_SMALL, f"{longest_m:.2f} m long, less than {least_m:.2f} m"
        return None

    def _flat(self, part: Float, rng: np.random.Generator) -> Found | None:
        sample = part[rng.integers(len(part), size=min(len(part), _FLAT_SAMPLE))]
        planes = planes_through(sample, rng.integers(len(sample), size=(3, 100)))
        if not len(planes):
            return PartKind.UNKNOWN, "its points span no plane"
        flat = int(counts_near(sample, planes, self._flat_margin_m).max()) / len(sample)
        if flat < self._flat_share:
            return None
        return PartKind.STRUCTURE, f"{flat:.0%} of its points are on one plane"

    def _upright(self, places: Float, heights: Float) -> Found | None:
        tall_m = float(np.ptp(heights))
        level = np.column_stack([places, np.zeros(len(places))])
        side_m = float(principal_extents(level)[0])
        if tall_m <= _UPRIGHT * side_m:
            return None
        return PartKind.STRUCTURE, f"stands upright: {tall_m:.2f} m high, {side_m:.2f} m wide"

    def _large(self, extents: Float, places: Float, heights: Float) -> Found | None:
        longest_m, narrowest_m = float(extents[0]), float(extents[2])
        if longest_m > self._limits.most_extent_m:
            told = f"{longest_m:.2f} m long, more than {self._limits.most_extent_m:.2f} m"
            tops = self._count_tops(places, heights)
            if tops > 1:
                return PartKind.STACK, f"{told}, with {tops} tops that could not be parted"
            return PartKind.TOO_LARGE, told
        if narrowest_m > self._limits.most_width_m:
            opening = f"more than the jaws' opening of {self._limits.most_width_m:.2f} m"
            return PartKind.TOO_LARGE, f"{narrowest_m:.2f} m wide, {opening}"
        return None

    def _hollow(self, part: Float, places: Float, heights: Float, longest_m: float) -> Found | None:
        most = _WHOLE * self._most_hollow
        if not is_hollow(part, most, longest_m):
            return None
        told = f"hollow by {hollow_share(part):.0%} of its length, one stone by at most {most:.0%}"
        if self._count_tops(places, heights) > 1:
            return PartKind.STACK, told
        return None  # one stone with a deep hollow


def left_out(points: Float, kind: PartKind, reason: str, centre: Float) -> LeftOut:
    """Return what is told of a part; its points are relative to a centre [m]."""
    mean = moments(points)[0] + centre
    return LeftOut(kind, reason, len(points), mean, principal_extents(points), points + centre)
