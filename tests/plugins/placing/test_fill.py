"""The fill of an envelope against volumes that are known by hand."""

import numpy as np
import pytest
from executive_plugins.placing.fill import fill_of

from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure
from executive.testing.exercises.building import bare, box, first_course


def test_boxes_on_the_ground_fill_their_share() -> None:
    fill = fill_of(first_course())
    assert fill.of_envelope == pytest.approx(3 * 0.96 * 0.7 * 0.4 / (3 * 0.8 * 0.9), rel=0.04)
    assert fill.below_top == pytest.approx(1.0)  # nothing is hollow below the tops


def test_a_bridge_has_a_void_below_it() -> None:
    piers = [standing(f"pier_{x}", (0.4, 0.8, 0.4), x, 0.2) for x in (-0.6, 0.6)]
    lintel = standing("lintel", (1.6, 0.8, 0.2), 0.0, 0.5)
    fill = fill_of(bare().with_standing(*piers, lintel))
    assert fill.below_top == pytest.approx((2 * 0.4 * 0.4 + 1.6 * 0.2) / (1.6 * 0.6), rel=0.03)


def test_an_overlap_and_what_sticks_out_count_once_and_not_at_all() -> None:
    one = standing("one", (1.0, 0.8, 0.4), 0.0, 0.2)
    twice = bare().with_standing(one, standing("same", (1.0, 0.8, 0.4), 0.0, 0.2))
    assert fill_of(twice) == fill_of(bare().with_standing(one))
    wide = bare().with_standing(standing("wide", (1.0, 1.6, 0.4), 0.0, 0.2))
    assert fill_of(wide).of_envelope == pytest.approx(fill_of(twice).of_envelope, rel=0.03)


def test_a_block_that_sank_into_the_ground_loses_only_what_sank() -> None:
    whole = bare().with_standing(standing("one", (1.0, 0.7, 0.4), 0.0, 0.2))
    sunk = bare().with_standing(standing("one", (1.0, 0.7, 0.4), 0.0, 0.199))
    assert fill_of(sunk).of_envelope == pytest.approx(fill_of(whole).of_envelope, rel=0.03)


def test_a_hollow_in_a_stone_is_no_stone() -> None:
    outer, inner = box("outer", 1.0, 0.8, 0.8), box("inner", 0.8, 0.6, 0.6)
    shell = SolidStone(
        "shell",
        np.vstack([outer.vertices, inner.vertices]),
        np.vstack([outer.triangles, inner.triangles[:, ::-1] + len(outer.vertices)]),
        100.0,
    )
    built = bare().with_standing(StandingStone(shell, pose(t=np.array([0.0, 0.0, 0.4]))))
    assert fill_of(built).below_top == pytest.approx(1 - 0.8 * 0.6 * 0.6 / (0.8 * 0.8), rel=0.06)


def test_a_turned_wall_is_filled_the_same() -> None:
    """The columns of cells do not follow the line of the wall."""
    turn = 0.7
    line = np.array([[-1.5, 0.0], [1.5, 0.0]]) @ exp_so3(np.array([0, 0, turn]))[:2, :2].T
    ground = HeightGrid.plane(np.array([-5.0, -5.0]), np.array([5.0, 5.0]))
    built = AsBuilt(Structure("turned", line, 0.8, 0.9), ground)
    T = pose(exp_so3(np.array([0.0, 0.0, turn])), np.array([0.0, 0.0, 0.2]))
    stone = StandingStone(box("one", 1.0, 0.8, 0.4), T)
    expected = 0.4 / (3 * 0.9)
    assert fill_of(built.with_standing(stone)).of_envelope == pytest.approx(expected, rel=0.04)


def standing(name: str, size: tuple[float, float, float], x: float, z: float) -> StandingStone:
    return StandingStone(box(name, *size), pose(t=np.array([x, 0.0, z])))
