"""Which segment is which known stone: by distance, and by the ratio of the sizes."""

import numpy as np
import pytest
from executive_plugins.objects.association import associate

from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState

CUBE = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3), axis=-1).reshape(-1, 3) / 3**0.5  # diagonal 1 m
LARGE_M = 2.0  # diagonal of the stone
MAX_RATIO = 2.0


def associated(diagonal_m: float, distance_m: float) -> bool:
    """Return whether a segment of a size at a distance is taken for the large stone."""
    model = LARGE_M * CUBE
    stone = Stone(1, StoneState.ON_GROUND, model, np.zeros(3), np.eye(4), True)
    points = diagonal_m * CUBE + [distance_m, 0.0, 0.0]
    segment = Segment(0, points, points.mean(axis=0), np.ones(3))
    return associate([segment], [stone], [5.0], MAX_RATIO) == [0]


@pytest.mark.parametrize(
    ("diagonal_m", "distance_m", "expected"),
    [
        (0.4, 0.8, True),  # a part of the stone, within half of its diagonal
        (0.4, 1.2, False),  # a pebble beyond it is not the stone that fell
        (1.2, 1.2, True),  # a stone of about its size is
        (3.9, 0.1, True),
        (4.1, 0.1, False),  # two merged stones are not one stone that has grown
        (2.0, 4.9, True),
        (2.0, 5.1, False),  # beyond the reach of the search
    ],
)
def test_size_and_distance_decide_together(
    diagonal_m: float, distance_m: float, expected: bool
) -> None:
    assert associated(diagonal_m, distance_m) is expected


def test_no_segment_or_no_stone_is_no_pair() -> None:
    assert associate([], [], [], MAX_RATIO) == []
    segment = Segment(0, CUBE, np.zeros(3), np.ones(3))
    assert associate([segment], [], [], MAX_RATIO) == [-1]
