"""The surroundings of a slot: the jaws' distance from neighbours, and the height under a stone."""

from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.placing.slot_surroundings import SlotFoot, SlotSurroundings

from executive.arrays import Float
from executive.geometry.polygon import Box
from executive.geometry.pose import inverse, pose, transform
from executive.machine.jaw_clearance import RELEASE_RAD, angle_closed_on
from executive.machine.machine import Machine
from executive.messages.placement import Slot

# A gripper that hangs: x down, its jaws open along y.
T_MAP_GRIPPER = pose(
    np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]), np.array([0.0, 0.0, 3.0])
)
STONE = np.array([[0.0, 0.0, 1.5]])


def outermost(machine: Machine, angle_rad: float = RELEASE_RAD) -> Float:
    """Return the corner of the gripper that is farthest along y, in the map [m].

    As it is by default, its jaws let go what is a point between its tips.
    """
    parts = machine.gripper.hulls(angle_rad).values()
    corners = transform(T_MAP_GRIPPER, np.vstack([hull for hulls in parts for hull in hulls]))
    return np.asarray(corners[corners[:, 1].argmax()])


def lowest(machine: Machine) -> Float:
    """Return the lowest corner of the jaws that let go what is a point between its tips [m]."""
    parts = machine.gripper.hulls(RELEASE_RAD / 2).values()
    corners = transform(T_MAP_GRIPPER, np.vstack([hull for hulls in parts for hull in hulls]))
    return np.asarray(corners[corners[:, 2].argmin()])


def test_jaws_keep_ten_centimetres_from_a_neighbour(machine: Machine, site: tuple) -> None:
    ground: Callable[..., Float] = site[1]
    for apart_m, is_free in ((0.05, False), (0.15, True)):
        neighbour = outermost(machine) + (0.0, apart_m, 0.0)
        cloud = np.vstack([ground(4.0), neighbour])
        around = SlotSurroundings(machine.gripper, cloud, SlotFoot(np.zeros(3), 0.5))
        assert around.is_free(T_MAP_GRIPPER, STONE) == is_free


def test_jaws_need_room_for_letting_go_and_not_for_all_of_their_opening(
    machine: Machine, site: tuple
) -> None:
    ground: Callable[..., Float] = site[1]
    in_the_way = outermost(machine, machine.gripper.open_rad)
    cloud = np.vstack([ground(4.0), in_the_way])
    around = SlotSurroundings(machine.gripper, cloud, SlotFoot(np.zeros(3), 0.5))
    assert around.is_free(T_MAP_GRIPPER, STONE)
    # Jaws that hold a stone of 1.7 m have to open as far as they can.
    wide = np.column_stack([np.zeros(35), np.linspace(-0.85, 0.85, 35), np.full(35, 2.2)])
    assert not around.is_free(T_MAP_GRIPPER, wide)


def test_jaws_may_be_in_the_ground_as_far_as_they_dig(machine: Machine, site: tuple) -> None:
    ground: Callable[..., Float] = site[1]
    for deep_m, is_free in ((0.0, True), (0.1, True), (0.25, False)):
        level = lowest(machine)[2] + deep_m
        cloud = ground(4.0) + (0.0, 0.0, level)
        around = SlotSurroundings(machine.gripper, cloud, SlotFoot(np.array([0, 0, level]), 0.5))
        assert around.is_free(T_MAP_GRIPPER, STONE) == is_free
        posed = SlotFoot(np.array([0, 0, level]), 0.5, lowered_m=0.0)
        on_soil = SlotSurroundings(machine.gripper, cloud, posed)
        assert on_soil.is_free(T_MAP_GRIPPER, STONE) == is_free


@pytest.mark.parametrize(
    ("deep_m", "drop_m", "is_free"),
    [(0.1, 0.0, False), (-0.02, 0.0, False), (-0.07, 0.0, True), (-0.07, 0.05, False),
     (-0.12, 0.05, True)],
)  # fmt: skip
def test_jaws_keep_five_centimetres_above_the_stones_of_a_place_on_others(
    machine: Machine, site: tuple, deep_m: float, drop_m: float, is_free: bool
) -> None:
    """What is below the stone is no ground: around it the ground is half a metre lower.

    The stone is checked above its place, and its jaws go down with it.
    """
    ground: Callable[..., Float] = site[1]
    level = lowest(machine)[2] + deep_m
    cloud = ground(4.0) + (0.0, 0.0, level)
    cloud[np.linalg.norm(cloud[:, :2], axis=1) > 1.2, 2] -= 0.5
    posed = SlotFoot(np.array([0.0, 0.0, level]), 0.5, lowered_m=drop_m)
    around = SlotSurroundings(machine.gripper, cloud, posed)
    assert around.is_free(T_MAP_GRIPPER, STONE) == is_free


def test_jaws_do_not_dig_into_the_foot_of_a_neighbour(machine: Machine, site: tuple) -> None:
    """What is at most 15 cm high is ground, but not beside what is higher."""
    ground: Callable[..., Float] = site[1]
    tip = lowest(machine)
    level = tip[2] + 0.1
    slot = SlotFoot(np.array([0.0, 0.0, level]), 0.5, lowered_m=0.0)
    cloud = ground(4.0) + (0.0, 0.0, level)
    higher = np.array([tip + (0.0, 0.12, 0.5)])  # beside the jaw, and farther than 5 cm from it
    for more, is_free in ((np.empty((0, 3)), True), (higher, False)):
        around = SlotSurroundings(machine.gripper, np.vstack([cloud, more]), slot)
        assert around.is_free(T_MAP_GRIPPER, STONE) == is_free


def test_the_stone_keeps_ten_centimetres_from_a_neighbour(machine: Machine, site: tuple) -> None:
    ground: Callable[..., Float] = site[1]
    neighbour = outermost(machine) + (0.0, 0.5, 0.0)
    cloud = np.vstack([ground(4.0), neighbour])
    around = SlotSurroundings(machine.gripper, cloud, SlotFoot(np.zeros(3), 0.5))
    assert around.is_free(T_MAP_GRIPPER, neighbour[None] - (0.0, 0.11, 0.0))
    assert not around.is_free(T_MAP_GRIPPER, neighbour[None] - (0.0, 0.09, 0.0))


def test_a_stone_comes_to_lie_on_the_high_side_of_sloping_ground(
    machine: Machine, site: tuple
) -> None:
    ground = site[1](4.0)
    ground[:, 2] = 0.1 * ground[:, 0]
    around = SlotSurroundings(machine.gripper, ground, SlotFoot(np.zeros(3), 1.0))
    under = ground[np.linalg.norm(ground[:, :2], axis=1) < 0.8, 2]
    assert 0.02 <= np.mean(under > around.ground_m) <= 0.08


def test_neighbours_come_as_near_as_half_the_gap_and_ten_centimetres_at_most() -> None:
    place, box = np.array([2.0, 1.0, 0.1]), Box(np.zeros(2), 1.0, 0.5, 0.0)
    alone, narrow, wide = (Slot(1, place, 0.0, gap_m) for gap_m in (None, 0.08, 0.5))
    feet = [SlotFoot.of(slot, 0.7, box) for slot in (alone, narrow, wide)]
    assert [foot.apart_m for foot in feet] == [0.1, 0.04, 0.1]
    low, high = feet[1].corners_map.min(axis=0), feet[1].corners_map.max(axis=0)
    np.testing.assert_allclose([low, high], [[1.6, 0.8], [2.4, 1.2]])  # four fifths of the box
    assert SlotFoot.of(narrow, 0.7, None).corners_map is None
    assert SlotFoot.of(narrow, 0.7, None).apart_m == 0.04


@pytest.mark.parametrize(
    ("below_m", "drop_m", "is_free"),
    [(0.02, 0.0, False), (0.08, 0.0, True), (0.08, 0.05, False), (0.12, 0.05, True)],
)
def test_jaws_keep_five_centimetres_above_neighbours_where_the_stone_is_to_rest(
    machine: Machine, site: tuple, below_m: float, drop_m: float, is_free: bool
) -> None:
    """A stone of a structure is checked above its place, and its jaws go down with it."""
    ground: Callable[..., Float] = site[1]
    neighbour = lowest(machine) - (0.0, 0.0, below_m)
    slot = Slot(1, np.zeros(3), None, 0.0, np.eye(4))
    around = SlotSurroundings(
        machine.gripper,
        np.vstack([ground(4.0), neighbour]),
        SlotFoot.of(slot, 0.5, None, drop_m),
    )
    assert around.is_free(T_MAP_GRIPPER, STONE) == is_free


@pytest.mark.parametrize(("below_m", "is_free"), [(0.02, False), (0.10, True)])
def test_tips_that_hold_a_stone_below_its_widest_part_come_down_there(
    machine: Machine, site: tuple, below_m: float, is_free: bool
) -> None:
    """What they pass once they have opened is not all that they could meet on their way down."""
    y_m = np.linspace(-1.0, 1.0, 41)
    wide, narrow = T_MAP_GRIPPER[2, 3] - 0.7, T_MAP_GRIPPER[2, 3] - 1.1
    stone = np.vstack(
        [
            np.column_stack([np.zeros(41), 0.5 * y_m, np.full(41, wide)]),
            np.column_stack([np.zeros(41), 0.2 * y_m, np.full(41, narrow)]),
        ]
    )
    held_rad = angle_closed_on(machine.gripper, transform(inverse(T_MAP_GRIPPER), stone))
    tip = transform(T_MAP_GRIPPER, machine.gripper.tips(held_rad))[0]
    cloud = np.vstack([site[1](4.0), tip - (0.0, 0.0, below_m)])
    slot = Slot(1, np.zeros(3), None, 0.0, np.eye(4))
    around = SlotSurroundings(machine.gripper, cloud, SlotFoot.of(slot, 0.5, None))
    assert around.is_free(T_MAP_GRIPPER, stone) == is_free


def test_stones_under_one_that_rests_on_them_are_no_ground(machine: Machine, site: tuple) -> None:
    """The highest part of free ground bears a stone; a slot with a pose says the height itself."""
    bed = site[1](4.0) + (0.0, 0.0, 0.3)
    posed = Slot(1, np.zeros(3), None, 0.0, np.eye(4))
    heights_m = [
        SlotSurroundings(machine.gripper, bed, SlotFoot.of(slot, 0.5, None)).ground_m
        for slot in (Slot(1, np.zeros(3)), posed)
    ]
    np.testing.assert_allclose(heights_m, [0.3, 0.0], atol=0.05)
