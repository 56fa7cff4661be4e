"""Rows of stones by the distance of their faces, on sites that are drawn by hand."""

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from executive.geometry.polygon import outline_gap, rectangle
from executive.geometry.pose import inverse, pose, transform
from executive.messages.cloud import Cloud
from executive.messages.placement import Slot
from executive.messages.region import Region
from executive.messages.slot_layout import Row, SlotLayout
from executive.messages.stone import Stone, StoneState

BASE = pose(t=np.array([0.0, 0.0, 0.9]))
ROW = Row(np.array([4.0, 5.0]), np.pi, 0.3)


def known(number: int, at: tuple[float, float], length_m: float, width_m: float) -> Stone:
    corners = rectangle(np.array(at), length_m, width_m, 0.4)
    points = np.vstack([np.c_[corners, np.full(4, z)] for z in (0.0, 0.6)])
    return Stone(number, StoneState.ON_GROUND, points, points.mean(axis=0), np.eye(4), True)


STONES = (known(1, (5, -2), 1.6, 1.2), known(2, (6, 0), 1.2, 1.0), known(3, (5, 2), 1.0, 0.8))


def boxes(slots: tuple[Slot, ...], stones: tuple[Stone, ...] = STONES) -> list[np.ndarray]:
    return [
        rectangle(slot.position_map[:2], one.box_map.length_m, one.box_map.width_m, np.pi)
        for slot, one in zip(slots, stones, strict=True)
    ]


def test_faces_are_apart_by_the_gap_whatever_the_sizes(planner_of: Callable, site: tuple) -> None:
    _, ground, segmented, _ = site
    layout = SlotLayout(row=ROW, stones=STONES)
    slots = planner_of().slots(segmented(ground()), BASE, 3, layout)
    placed = boxes(slots)
    assert placed[0][:, 0].max() == pytest.approx(4.0)
    for one, two in itertools.pairwise(placed):
        assert outline_gap(one, two) == pytest.approx(0.3, abs=0.02)
    assert all((slot.heading_rad, slot.gap_m) == (np.pi, 0.3) for slot in slots)
    assert all(slot.position_map[1] == pytest.approx(5.0) for slot in slots)


def test_a_row_is_continued_after_the_stones_that_stand_in_it(
    planner_of: Callable, site: tuple
) -> None:
    _, ground, segmented, _ = site
    first = known(9, (3.2, 5.0), 1.2, 1.0)
    layout = SlotLayout(row=ROW, stones=STONES[:1], standing=(first,))
    (slot,) = planner_of().slots(segmented(ground()), BASE, 1, layout)
    (placed,) = boxes((slot,), STONES[:1])
    assert outline_gap(placed, first.outline_map) == pytest.approx(0.3, abs=0.02)


def test_regions_to_keep_off_and_to_use_bound_rows_and_arcs(
    planner_of: Callable, site: tuple
) -> None:
    _, ground, segmented, _ = site
    seen, planner = segmented(ground()), planner_of()
    off = Region("off", rectangle(np.array([0.5, 5.0]), 2.0, 3.0, 0.0))
    row = planner.slots(seen, BASE, 3, SlotLayout(row=ROW, stones=STONES, keep_off=(off,)))
    assert len(row) > 1
    for box in boxes(row, STONES[: len(row)]):
        assert not off.touches(box)
    half = Region("left", np.array([[-9.0, 0.5], [9.0, 0.5], [9.0, 9.0], [-9.0, 9.0]]))
    arcs = planner.slots(seen, BASE, 4, SlotLayout(use=(half,), keep_off=(off,), stones=STONES))
    assert arcs
    radius_m = np.hypot(1.6, 1.2) / 2  # the largest may come to any of them, turned in any way
    for slot in arcs:
        assert half.depth_m(slot.position_map[None])[0] >= radius_m - 1e-6
        assert off.depth_m(slot.position_map[None])[0] <= -radius_m + 1e-6


def test_a_row_without_room_gives_no_slot(planner_of: Callable, site: tuple) -> None:
    _, ground, segmented, _ = site
    everywhere = Region("all", np.array([[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30, 30]]))
    layout = SlotLayout(row=ROW, stones=STONES, keep_off=(everywhere,))
    assert planner_of().slots(segmented(ground()), BASE, 3, layout) == ()


def test_a_stone_is_set_down_with_its_longer_side_along_the_row(
    planner_of: Callable, site: tuple
) -> None:
    _, ground, _, held = site
    _, T_map_gripper = held((5.0, -2.0))
    stone = known(1, (5.0, -2.0), 1.4, 0.8)
    slot = Slot(1, np.array([0.0, 6.0, 0.0]), heading_rad=0.3, gap_m=0.1)
    ways = planner_of().plan(stone, slot, T_map_gripper, Cloud("map", ground()), BASE)
    assert ways
    moved = transform(ways[0].T_map_gripper @ inverse(T_map_gripper), stone.points_map)
    box = Stone(1, StoneState.HELD, moved, moved.mean(axis=0), np.eye(4), True).box_map
    np.testing.assert_allclose(box.centre, [0.0, 6.0], atol=1e-6)
    assert np.cos(2 * (box.heading_rad - 0.3)) == pytest.approx(1.0, abs=1e-3)
