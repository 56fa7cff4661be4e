"""Association of segments with known stones."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.objects.surface import box_centre, diagonal_m
from scipy.optimize import linear_sum_assignment

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.convex import depth_inside, half_spaces
from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent

_FORBIDDEN = 1e6  # cost of an impossible pair
_NO_SIZE = 1e-3  # ratio of the sizes of a segment of one point, and a stone
_MOST = 0.5  # share of a segment's points beyond which it is a piece of the body around them
PIECE = "piece"  # kind of event of a stone whose model holds a segment: it tells no pose
_NO_POSE = frozenset({PIECE, "state"})  # kinds of events that tell nothing of where a stone is


@dataclass(frozen=True, slots=True)
class Reach:
    """How far a stone may be from its stored position.

    Attributes:
        most_m: Largest distance [m].
        may_have_rolled: It was released, or is lost: it need not lie where it was last.
    """

    most_m: float
    may_have_rolled: bool = False


def associate(
    segments: Sequence[Segment],
    stones: Sequence[Stone],
    reaches: Sequence[Reach],
    max_ratio: float,
) -> list[int]:
    """Assign segments to stones, one to one, with the least sum of costs.

    The cost of a pair is its distance over the diagonal of the stone's box. For a stone that may
    have rolled, that of the sizes is added, 1 at the largest ratio: beside where it was, a small
    part of something is less likely to be the stone than what has its size farther away. A stone
    that lies where it was may be seen in part.

    Args:
        segments: The segments of a view.
        stones: The stones that may be among them.
        reaches: How far each stone may be from its stored position.
        max_ratio: Largest ratio of the box diagonals of a pair: two merged stones are not one stone
            that has grown. For a stone farther away than half its own diagonal the inverse ratio is
            bounded as well: a pebble is not the stone that fell.

    Returns:
        For each segment the row of its stone, or −1.
    """
    if not segments or not stones:
        return [-1] * len(segments)
    costs = np.full((len(segments), len(stones)), _FORBIDDEN)
    for i, segment in enumerate(segments):
        for j, stone in enumerate(stones):
            distance, size_m = _distance_m(segment, stone), diagonal_m(stone.points_map)
            ratio = diagonal_m(segment.points) / size_m
            least = 1 / max_ratio if distance > 0.5 * size_m else 0.0
            if distance <= reaches[j].most_m and least <= ratio <= max_ratio:
                costs[i, j] = distance / size_m
                if reaches[j].may_have_rolled:
                    costs[i, j] += abs(np.log(max(ratio, _NO_SIZE))) / np.log(max_ratio)
    partners = [-1] * len(segments)
    for i, j in zip(*linear_sum_assignment(costs), strict=True):
        if costs[i, j] < _FORBIDDEN:
            partners[i] = int(j)
    return partners


def associate_known_first(
    segments: Sequence[Segment],
    stones: Sequence[Stone],
    reaches: Sequence[Reach],
    max_ratio: float,
    agrees: Callable[[Stone, Segment], bool],
    pushed: Reach,
) -> list[int]:
    """Assign segments as `associate` does, and to lost stones only what no other stone explains.

    A lost stone may be far from its stored position, so a segment beside a stone that is not lost
    is not that of a lost one, if it has the surface of the stone that lies there. Where it has not,
    the lost stone may have fallen onto that one and pushed it: both are sought among what is left.

    Args:
        segments: The segments of a view.
        stones: The stones that may be among them.
        reaches: How far each stone may be from its stored position.
        max_ratio: As in `associate`.
        agrees: Tells whether a segment has the surface of a stone that lies where it was, or was
            moved without turning; asked if a stone is lost.
        pushed: How far a stone may be that is not where it lay.
    """
    lost = [j for j, one in enumerate(stones) if one.state is StoneState.LOST]
    lying = [j for j, one in enumerate(stones) if one.state is not StoneState.LOST]
    partners = [-1] * len(segments)
    _assign(partners, lying, segments, stones, reaches, max_ratio)
    if not lost:
        return partners
    moved = [i for i, j in enumerate(partners) if j >= 0 and not agrees(stones[j], segments[i])]
    sought = lost + [partners[i] for i in moved]
    reaches = [pushed if j in sought and j not in lost else one for j, one in enumerate(reaches)]
    for i in moved:
        partners[i] = -1
    _assign(partners, sorted(sought), segments, stones, reaches, max_ratio)
    return partners


def _assign(
    partners: list[int],
    rows: Sequence[int],
    segments: Sequence[Segment],
    stones: Sequence[Stone],
    reaches: Sequence[Reach],
    max_ratio: float,
) -> None:
    """Give the segments without a partner to some of the stones."""
    left = [i for i, partner in enumerate(partners) if partner < 0]
    found = associate(
        [segments[i] for i in left],
        [stones[j] for j in rows],
        [reaches[j] for j in rows],
        max_ratio,
    )
    for i, row in zip(left, found, strict=True):
        partners[i] = rows[row] if row >= 0 else -1


def owner_of_piece(segment: Segment, stones: Sequence[Stone], distance_m: float) -> Stone | None:
    """Return the stone that a segment is a piece of, or None.

    A stone of which the map shows parts comes in several segments, and one of them is its partner.
    The others are no stones of their own: bodies do not share space, so what lies for the most part
    in the convex hull of a known stone is of that stone.

    Args:
        segment: A segment that is no stone's partner.
        stones: The stones that lie at their poses.
        distance_m: How far outside the hull a point may be, by the errors of map and model [m].
    """
    shares = [_share_inside(segment.points, stone.points_map, distance_m) for stone in stones]
    if not shares or max(shares) <= _MOST:
        return None
    return stones[int(np.argmax(shares))]


def reach_of(
    stone: Stone, history: Sequence[StoneEvent], max_distance_m: float, max_roll_m: float
) -> Reach:
    """Return how far a stone may be from its stored position.

    Args:
        stone: The stone.
        history: Its events, oldest first.
        max_distance_m: Of a stone that lies where it was seen [m].
        max_roll_m: Of one that was released and not seen since [m]. One that is lost may lie
            anywhere on the way that it was carried last as well.
    """
    if stone.state is StoneState.LOST:
        return Reach(max_roll_m + carried_m(history), may_have_rolled=True)
    if newest_pose(history).kind == "release":
        return Reach(max_roll_m, may_have_rolled=True)
    return Reach(max_distance_m)


def newest_pose(history: Sequence[StoneEvent]) -> StoneEvent:
    """Return the newest event of a stone that tells where it is."""
    return next(event for event in reversed(history) if event.kind not in _NO_POSE)


def carried_m(history: Sequence[StoneEvent]) -> float:
    """Return how far a stone was carried to its last release [m]: it may have fallen on that way.

    Zero for a stone that was seen since.
    """
    poses = [event for event in history if event.kind not in _NO_POSE]
    if len(poses) < 2 or poses[-1].kind != "release":
        return 0.0
    return float(np.linalg.norm((poses[-1].T_map_object - poses[-2].T_map_object)[:3, 3]))


def _share_inside(points: Float, model: Float, distance_m: float) -> float:
    """Return the share of points (N, 3) in the hull of a model (M, 3), or this near to it."""
    low, high = model.min(axis=0) - distance_m, model.max(axis=0) + distance_m
    near = points[((points >= low) & (points <= high)).all(axis=1)]
    if len(near) <= _MOST * len(points):
        return 0.0
    try:
        depths_m = depth_inside(half_spaces(model), near)
    except DataError:  # a flat model has no inside
        return 0.0
    return float(np.count_nonzero(depths_m >= -distance_m) / len(points))


def _distance_m(segment: Segment, stone: Stone) -> float:
    """Return the distance of a segment from a stone [m].

    The centroid of a stone that is seen from one side is biased, so the smaller of the distances of
    centroids and of box centres counts.
    """
    boxes = box_centre(segment.points) - box_centre(stone.points_map)
    means = np.linalg.norm(segment.centroid - stone.centroid_map)
    return float(min(means, np.linalg.norm(boxes)))
