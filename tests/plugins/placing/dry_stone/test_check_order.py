"""The order of checks: the best first, and elsewhere once a stone did not hold."""

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.check_order import CheckOrder
from executive_plugins.placing.dry_stone.parts import Place

from executive.geometry.pose import pose
from executive.testing.exercises.building import box

SCORES = (5.0, 4.9, 4.8, 4.5)  # of two stones in one gap, one 0.1 m beside it, one 2 m away
XS = (0.0, 0.0, 0.1, 2.0)


def places():
    stone = box("stone", 0.5, 0.5, 0.5)
    return [Place(stone, pose(t=[x, 0, 0]), s, {}) for x, s in zip(XS, SCORES, strict=True)]


def checked(doubt, failed=()):
    """Return the places in the order in which they are checked, all of which fail."""
    order, seen = CheckOrder(places(), failed, doubt), []
    for place in order:
        seen.append(SCORES.index(place.score))
        order.fail_at(place.T_map_stone[:2, 3])
    return seen


@pytest.mark.parametrize(
    ("doubt", "order"), [(0.0, [0, 1, 2, 3]), (0.2, [0, 1, 3, 2]), (1.0, [0, 3, 1, 2])]
)
def test_a_place_elsewhere_is_next_where_a_stone_did_not_hold(doubt, order):
    assert checked(doubt) == order


def test_what_failed_before_counts_in_the_next_round():
    assert checked(1.0, [np.zeros(2)])[0] == 3


def test_no_places_are_no_order():
    assert list(CheckOrder([], [np.zeros(2)], 1.0)) == []
