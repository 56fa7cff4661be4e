"""What every placement planner must do, whatever its method."""

import numpy as np

from executive.geometry.pose import inverse, pose, transform
from executive.interfaces.placing import PlacementPlanner
from executive.messages.cloud import Cloud
from executive.messages.region import Region
from executive.messages.slot_layout import SlotLayout
from executive.testing.exercises.placing import BASE, HANGING, ground, site, stone_at
from executive.testing.pytest_plugin import Insist

CAPABILITY = "placing"


def test_slots_are_no_more_than_asked_apart_and_off_the_segments(
    plugin: PlacementPlanner, insist: Insist
) -> None:
    slots = plugin.slots(site(), BASE, 5)
    insist(slots, "it finds no slot on level ground")
    assert len(slots) <= 5
    assert [slot.id for slot in slots] == list(range(1, len(slots) + 1))
    places = np.array([slot.position_map for slot in slots])
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + 9 * np.eye(len(places))
    assert apart.min() > 1.0
    for segment in site().segments:
        assert np.linalg.norm(segment.points[:, None, :2] - places[None, :, :2], axis=2).min() > 0.5


def test_no_slots_are_asked_for_and_none_given(plugin: PlacementPlanner) -> None:
    assert plugin.slots(site(), BASE, 0) == ()


def test_slots_keep_off_a_region(plugin: PlacementPlanner, insist: Insist) -> None:
    left = Region("left", np.array([[-20.0, 0.0], [20.0, 0.0], [20.0, 20.0], [-20.0, 20.0]]))
    layout = SlotLayout(keep_off=(left,), stones=(stone_at(5.0, 0.0),))
    slots = plugin.slots(site(), BASE, 3, layout)
    insist(slots, "it finds no slot off half of the site")
    assert all(slot.position_map[1] < -0.4 for slot in slots)  # half of the stone's smaller side


def test_a_stone_ends_over_its_slot_and_on_the_ground(
    plugin: PlacementPlanner, insist: Insist
) -> None:
    stone, T_map_gripper = stone_at(5.0, 0.0), pose(HANGING, np.array([5.0, 0.0, 1.2]))
    slots = plugin.slots(site(), BASE, 1)
    insist(slots, "it finds no slot on level ground")
    slot = slots[0]
    ways = plugin.plan(stone, slot, T_map_gripper, Cloud("map", ground()), BASE)
    insist(ways, "it finds no way to set an ellipsoid down on level ground")
    moved = transform(ways[0].T_map_gripper @ inverse(T_map_gripper), stone.points_map)
    np.testing.assert_allclose(moved.mean(axis=0)[:2], slot.position_map[:2], atol=0.1)
    assert -0.02 < moved[:, 2].min() - slot.position_map[2] < 0.2
    np.testing.assert_allclose(
        ways[0].T_map_object,
        ways[0].T_map_gripper @ inverse(T_map_gripper) @ stone.T_map_object,
        atol=1e-9,
    )
