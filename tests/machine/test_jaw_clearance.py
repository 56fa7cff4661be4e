"""How far the jaws open to come free of a stone, by what the tips pass on the way up."""

import numpy as np
import pytest

from executive.arrays import Float
from executive.geometry.convex import depth_inside, half_spaces
from executive.machine.gripper import Gripper
from executive.machine.jaw_clearance import (
    RELEASE_RAD,
    angle_beside,
    angle_closed_on,
    angle_free_of,
    can_open,
    release_angles,
    released_jaws,
)
from executive.machine.machine import load_machine

UP = np.array([-1.0, 0.0, 0.0])  # the palm is above, the tips are below
ROOM_M = 0.05
STEP_RAD = 0.02


@pytest.fixture(scope="module")
def gripper() -> Gripper:
    return load_machine("m545").gripper


def bar(x_m: float, left_m: float, right_m: float, z_m: float = 0.0) -> Float:
    """Return a bar along y, from the right jaw's side to the left one's."""
    y = np.linspace(right_m, left_m, 81)
    return np.column_stack([np.full(81, x_m), y, np.full(81, z_m)])


def test_tips_that_are_below_a_stone_open_until_they_rise_past_it(gripper: Gripper) -> None:
    """The jaws have closed to 0.4 m below a stone that is 1 m wide: 0.2 rad more frees no tip."""
    angle_rad = angle_free_of(gripper, bar(0.7, 0.5, -0.5), UP, 0.36, ROOM_M)
    assert gripper.opening_m(0.36) < 1.0
    assert gripper.opening_m(angle_rad) >= 1.0 + 2 * ROOM_M
    assert gripper.opening_m(angle_rad - STEP_RAD) < 1.0 + 2 * ROOM_M


@pytest.mark.parametrize(("left_m", "right_m"), [(0.7, -0.2), (0.2, -0.7)])
def test_the_side_on_which_the_stone_reaches_farther_decides(
    gripper: Gripper, left_m: float, right_m: float
) -> None:
    angle_rad = angle_free_of(gripper, bar(0.7, left_m, right_m), UP, 0.3, ROOM_M)
    assert gripper.opening_m(angle_rad) / 2 == pytest.approx(0.7 + ROOM_M, abs=0.025)
    assert gripper.opening_m(angle_rad) / 2 >= 0.7 + ROOM_M


@pytest.mark.parametrize(
    ("stone", "why"),
    [
        (bar(1.3, 1.0, -1.0), "it lies below the tips"),
        (bar(0.7, 1.0, -1.0, z_m=0.28 + ROOM_M + 0.01), "it lies beside the jaws' width"),
        (bar(0.7, 0.2, -0.2), "the tips are farther apart already"),
        (np.zeros((0, 3)), "nothing was seen of it"),
    ],
)
def test_what_no_tip_passes_asks_for_no_more_than_the_least_angle(
    gripper: Gripper, stone: Float, why: str
) -> None:
    assert angle_free_of(gripper, stone, UP, 0.3, ROOM_M) == 0.3, why


def test_a_stone_wider_than_the_open_jaws_asks_for_all_of_their_opening(gripper: Gripper) -> None:
    assert angle_free_of(gripper, bar(0.7, 1.5, -1.5), UP, 0.3, ROOM_M) == gripper.open_rad


def test_jaws_that_lean_pass_more_of_the_stone_with_one_tip(gripper: Gripper) -> None:
    """Leaning by 0.3 rad, a tip that is 0.4 m below the bar comes 0.12 m nearer on its way up."""
    upright = angle_free_of(gripper, bar(0.7, 0.5, -0.5), UP, 0.2, ROOM_M)
    for lean_rad in (-0.3, 0.3):
        up = np.array([-np.cos(lean_rad), np.sin(lean_rad), 0.0])
        leaning = angle_free_of(gripper, bar(0.7, 0.5, -0.5), up, 0.2, ROOM_M)
        nearer_m = gripper.opening_m(leaning) / 2 - gripper.opening_m(upright) / 2
        assert nearer_m == pytest.approx(0.4 * np.tan(0.3), abs=0.06)


def test_jaws_open_beside_another_stone_as_far_as_there_is_room(gripper: Gripper) -> None:
    neighbour = bar(0.6, 1.6, 0.85)
    wanted_rad = 0.9
    angle_rad = angle_beside(gripper, neighbour, 0.4, wanted_rad, 0.0)
    assert 0.4 < angle_rad < wanted_rad
    assert angle_beside(gripper, neighbour, 0.4, angle_rad - 0.02, 0.0) == angle_rad - 0.02


def test_jaws_keep_their_room_to_another_stone(gripper: Gripper) -> None:
    """A jaw turns by some 5 cm of way at a metre from its hinge."""
    near_rad, apart_rad = (
        angle_beside(gripper, bar(0.6, 1.6, 0.85), 0.4, 0.9, room_m) for room_m in (0.0, ROOM_M)
    )
    assert near_rad - 0.15 < apart_rad < near_rad - 0.02


def test_without_a_neighbour_the_jaws_open_as_far_as_is_wanted(gripper: Gripper) -> None:
    assert angle_beside(gripper, np.zeros((0, 3)), 0.4, 0.9, ROOM_M) == 0.9
    assert angle_beside(gripper, bar(1.0, 3.0, 2.0), 0.4, 0.9, ROOM_M) == 0.9


def test_a_neighbour_that_is_met_at_each_angle_leaves_the_least_one(gripper: Gripper) -> None:
    """A wall all along the way of the left jaw's tip."""
    tips = [gripper.tips(angle_rad)[0] for angle_rad in np.arange(0.4, 0.95, 0.005)]
    wall = np.array([tip + [-depth_m, 0.0, 0.0] for tip in tips for depth_m in (0.02, 0.05, 0.1)])
    assert angle_beside(gripper, wall, 0.4, 0.9, 0.0) == 0.4


def test_a_stone_is_let_go_from_where_the_tips_pass_it_on(gripper: Gripper) -> None:
    angles = release_angles(gripper, bar(0.7, 0.5, -0.5), UP)
    assert gripper.opening_m(float(angles[0])) == pytest.approx(1.0, abs=0.05)
    assert np.diff(angles) == pytest.approx([RELEASE_RAD / 2, RELEASE_RAD / 2])
    assert (release_angles(gripper, bar(0.7, 1.5, -1.5), UP) == gripper.open_rad).all()


def test_jaws_that_let_a_stone_go_surround_it(gripper: Gripper) -> None:
    stone = bar(0.7, 0.5, -0.5)
    points = released_jaws(gripper, stone, UP)
    tips = gripper.tips(float(release_angles(gripper, stone, UP)[-1]))
    for tip in tips:
        assert np.linalg.norm(points - tip, axis=1).min() < 0.06
    beside = points[(np.abs(points[:, 0] - 0.7) < 0.05)]
    assert np.abs(beside[:, 1]).min() > 0.45
    assert points[:, 0].min() < 0.0  # the palm
    assert np.ptp(points[:, 2]) == pytest.approx(gripper.jaw_width_m, abs=0.05)


def test_jaws_open_where_no_stone_is_on_their_way(gripper: Gripper) -> None:
    nothing = np.zeros((0, 3))
    assert can_open(gripper, nothing, 0.3, gripper.open_rad, ROOM_M)
    far = bar(3.0, 0.5, -0.5)
    assert can_open(gripper, far, 0.3, gripper.open_rad, ROOM_M)


def test_a_stone_at_the_end_or_halfway_of_the_opening_is_in_the_way(gripper: Gripper) -> None:
    for at_rad in (gripper.open_rad, (0.3 + gripper.open_rad) / 2):
        tip = gripper.tips(at_rad).max(axis=0)
        stone = tip + np.random.default_rng(0).uniform(-0.03, 0.03, (50, 3))
        assert not can_open(gripper, stone, 0.3, gripper.open_rad, ROOM_M)


@pytest.mark.parametrize("half_m", [0.2, 0.4, 0.6])
def test_jaws_close_until_they_touch_the_stone(gripper: Gripper, half_m: float) -> None:
    def touches(angle_rad: float) -> bool:
        parts = gripper.hulls(angle_rad)
        hulls = [half_spaces(corners) for name in gripper.links for corners in parts[name]]
        return any((depth_inside(faces, stone) > 0.0).any() for faces in hulls)

    stone = bar(1.0, half_m, -half_m)
    angle_rad = angle_closed_on(gripper, stone)
    assert 0.0 < angle_rad < gripper.open_rad
    assert not touches(angle_rad)
    assert touches(angle_rad - STEP_RAD)


def test_jaws_meet_without_a_stone_and_stay_open_on_a_wide_one(gripper: Gripper) -> None:
    assert angle_closed_on(gripper, bar(3.0, 0.2, -0.2)) == 0.0
    assert angle_closed_on(gripper, bar(0.7, 1.5, -1.5)) == gripper.open_rad


def test_tips_that_have_closed_below_a_stone_are_part_of_the_jaws_around_it(
    gripper: Gripper,
) -> None:
    """They hold it by its lower part; from where they pass its widest part on they let it go."""
    stone = np.vstack([bar(0.7, 0.5, -0.5), bar(1.1, 0.2, -0.2)])
    held_rad = angle_closed_on(gripper, stone)
    least_rad = float(release_angles(gripper, stone, UP)[0])
    assert held_rad < least_rad - 0.1
    points = released_jaws(gripper, stone, UP)
    for angle_rad in (held_rad, least_rad):
        away = [np.linalg.norm(points - tip, axis=1).min() for tip in gripper.tips(angle_rad)]
        assert max(away) < 0.08
