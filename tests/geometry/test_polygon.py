"""Simple polygons, against areas, distances and boxes that are known otherwise."""

import numpy as np
import pytest

from executive.errors import DataError
from executive.geometry.polygon import (
    area_m2,
    contains,
    crosses_itself,
    distance_to_outline,
    outline_gap,
    outline_of,
    rectangle,
    smallest_box,
)

SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
HOOK = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [0.0, 1.0]])


def test_the_area_is_signed_by_the_direction_of_the_corners():
    assert area_m2(SQUARE) == pytest.approx(2.0)
    assert area_m2(SQUARE[::-1]) == pytest.approx(-2.0)
    assert area_m2(HOOK) == pytest.approx(5.0)


def test_the_share_of_random_points_inside_is_the_area():
    points = np.random.default_rng(0).uniform(0, 3, (20_000, 2))
    assert contains(HOOK, points).mean() * 9 == pytest.approx(5.0, abs=0.15)
    assert not contains(HOOK, np.array([[1.0, 2.0]]))[0]  # in the hull, not in the hook


def test_distances_are_those_to_the_nearest_edge():
    found = distance_to_outline(SQUARE, np.array([[1.0, 0.4], [3.0, 0.5], [3.0, 2.0]]))
    np.testing.assert_allclose(found, [0.4, 1.0, np.sqrt(2)])


@pytest.mark.parametrize(("shift", "gap"), [((3.0, 0.0), 1.0), ((1.0, 0.2), 0.0), ((5, 5), 5.0)])
def test_the_gap_of_two_outlines(shift, gap):
    assert outline_gap(SQUARE, SQUARE + shift) == pytest.approx(gap)


def test_outlines_that_cross_without_a_corner_inside_have_no_gap():
    assert outline_gap(rectangle(np.zeros(2), 4, 1, 0.0), rectangle(np.zeros(2), 4, 1, 1.5)) == 0.0


def test_an_outline_that_crosses_itself_is_seen():
    assert not crosses_itself(HOOK)
    assert crosses_itself(SQUARE[[0, 2, 1, 3]])


@pytest.mark.parametrize("heading", [-1.2, 0.0, 0.4, 1.5])
def test_the_smallest_box_of_a_turned_rectangle_is_that_rectangle(heading):
    box = smallest_box(outline_of(rectangle(np.array([3.0, -1.0]), 2.0, 0.7, heading)))
    np.testing.assert_allclose(box.centre, [3.0, -1.0], atol=1e-9)
    assert (box.length_m, box.width_m) == pytest.approx((2.0, 0.7))
    assert np.cos(2 * (box.heading_rad - heading)) == pytest.approx(1.0)


def test_points_on_one_line_have_no_outline():
    with pytest.raises(DataError, match="no outline"):
        outline_of(np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]))
