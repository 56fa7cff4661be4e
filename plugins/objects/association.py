"""Association of segments with known stones."""

from collections.abc import Sequence

import numpy as np
from executive_plugins.objects.surface import box_centre, diagonal_m
from scipy.optimize import linear_sum_assignment

from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent

_FORBIDDEN = 1e6  # cost of an impossible pair [m]


def associate(
    segments: Sequence[Segment],
    stones: Sequence[Stone],
    reaches_m: Sequence[float],
    max_ratio: float,
) -> list[int]:
    """Assign segments to stones, one to one, with the least sum of distances.

    Args:
        segments: The segments of a view.
        stones: The stones that may be among them.
        reaches_m: Largest distance of each stone from its stored position [m].
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
            distance = _distance_m(segment, stone)
            ratio = diagonal_m(segment.points) / diagonal_m(stone.points_map)
            least = 1 / max_ratio if distance > 0.5 * diagonal_m(stone.points_map) else 0.0
            if distance <= reaches_m[j] and least <= ratio <= max_ratio:
                costs[i, j] = distance
    partners = [-1] * len(segments)
    for i, j in zip(*linear_sum_assignment(costs), strict=True):
        if costs[i, j] < _FORBIDDEN:
            partners[i] = int(j)
    return partners


def associate_known_first(
    segments: Sequence[Segment],
    stones: Sequence[Stone],
    reaches_m: Sequence[float],
    max_ratio: float,
) -> list[int]:
    """Assign segments as `associate` does, and to lost stones only what no other stone explains.

    A lost stone may be far from its stored position, so a segment beside a stone that is not lost
    is not that of a lost one.
    """
    partners = [-1] * len(segments)
    for is_lost in (False, True):
        rows = [j for j, one in enumerate(stones) if (one.state is StoneState.LOST) is is_lost]
        left = [i for i, partner in enumerate(partners) if partner < 0]
        found = associate(
            [segments[i] for i in left],
            [stones[j] for j in rows],
            [reaches_m[j] for j in rows],
            max_ratio,
        )
        for i, row in zip(left, found, strict=True):
            partners[i] = rows[row] if row >= 0 else -1
    return partners


def carried_m(history: Sequence[StoneEvent]) -> float:
    """Return how far a stone was carried to its last release [m]: it may have fallen on that way.

    Zero for a stone that was seen since.
    """
    poses = [event for event in history if event.kind != "state"]
    if len(poses) < 2 or poses[-1].kind != "release":
        return 0.0
    return float(np.linalg.norm((poses[-1].T_map_object - poses[-2].T_map_object)[:3, 3]))


def _distance_m(segment: Segment, stone: Stone) -> float:
    """Return the distance of a segment from a stone [m].

    The centroid of a stone that is seen from one side is biased, so the smaller of the distances of
    centroids and of box centres counts.
    """
    boxes = box_centre(segment.points) - box_centre(stone.points_map)
    means = np.linalg.norm(segment.centroid - stone.centroid_map)
    return float(min(means, np.linalg.norm(boxes)))
