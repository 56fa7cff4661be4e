"""Places in regions to use and off regions to keep off, to the exact border."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.placing.allowed_places import AllowedPlaces

from executive.messages.region import Region
from executive.messages.slot_layout import SlotLayout


def square(name: str, low: float, high: float) -> Region:
    return Region(name, np.array([[low, low], [high, low], [high, high], [low, high]]))


def stone(length_m: float, width_m: float) -> SimpleNamespace:
    return SimpleNamespace(box_map=SimpleNamespace(length_m=length_m, width_m=width_m))


# The larger one turns within a circle of 0.5 m, half of the diagonal of its box.
STONES = (stone(0.3, 0.4), stone(0.6, 0.8), stone(0.5, 0.5))
YARD, POND = square("yard", 0.0, 8.0), square("pond", 3.0, 5.0)


def at(x: float, y: float, **layout: tuple) -> bool:
    made = SlotLayout(stones=STONES, **layout)  # type: ignore[arg-type]
    return AllowedPlaces(made).at(np.array([x, y]))


def test_without_regions_every_place_is_allowed() -> None:
    assert at(-100.0, 3.0)


@pytest.mark.parametrize(
    ("x", "is_allowed"),
    [(0.499, False), (0.501, True), (7.499, True), (7.501, False), (9, False)],
)
def test_the_largest_stone_lies_in_a_region_to_use_as_a_whole(x: float, is_allowed: bool) -> None:
    assert at(x, 1.0, use=(YARD,)) is is_allowed
    assert at(1.0, x, use=(square("far", 50.0, 60.0), YARD)) is is_allowed  # in any of them


@pytest.mark.parametrize(
    ("x", "is_allowed"),
    [(2.499, True), (2.501, False), (4, False), (5.499, False), (5.501, True)],
)
def test_no_stone_comes_into_a_region_to_keep_off(x: float, is_allowed: bool) -> None:
    assert at(x, 4.0, keep_off=(POND,)) is is_allowed
    assert at(x, 4.0, use=(YARD,), keep_off=(square("far", 50.0, 60.0), POND)) is is_allowed


def test_a_stone_may_touch_a_border_from_its_side() -> None:
    small = SlotLayout(stones=(stone(0.6, 0.8),), use=(YARD,), keep_off=(POND,))  # type: ignore[arg-type]
    places = AllowedPlaces(small)
    assert places.at(np.array([0.5, 1.0]))
    assert places.at(np.array([2.5, 4.0]))


def test_without_stones_a_place_is_a_point() -> None:
    places = AllowedPlaces(SlotLayout(use=(YARD,), keep_off=(POND,)))
    assert places.at(np.array([0.001, 0.001]))
    assert places.at(np.array([2.999, 4.0]))
    assert not places.at(np.array([3.001, 4.0]))
    assert not places.at(np.array([-0.001, 4.0]))
