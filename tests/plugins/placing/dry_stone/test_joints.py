"""Joints of a course: what covers them, what lets them run, and what has none."""

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.joints import Joints

from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure

STRAIGHT = np.array([[-3.0, 0.0], [3.0, 0.0]])
_ANGLES = np.linspace(0.0, 2 * np.pi, 49)
RING = 2.0 * np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])
CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.3, 0.3) for z in (-0.25, 0.25)])
TRIANGLES = np.array([
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
])  # fmt: skip
BLOCK = SolidStone.of_mesh("block", CORNERS, TRIANGLES, 2600.0)  # 1 m along, 0.5 m high


def joints(line: np.ndarray, *poses: np.ndarray) -> Joints:
    ground = HeightGrid.plane(np.full(2, -4.0), np.full(2, 4.0))
    built = AsBuilt(Structure("wall", line, 1.3, 1.5), ground)
    return Joints(built.with_standing(*(StandingStone(BLOCK, T) for T in poses)))


def along_x(x: float, z: float = 0.25) -> np.ndarray:
    return pose(t=np.array([x, 0.0, z]))


def closed(found: Joints, x: float, z: float = 0.75) -> float:
    return float(found.closed(np.array([[x, 0.0, z]]), np.eye(3), BLOCK.vertices)[0])


def test_a_stone_on_two_covers_their_joint() -> None:
    found = joints(STRAIGHT, along_x(-0.5), along_x(0.5))
    assert found.along == pytest.approx([3.0])
    assert closed(found, 0.0) == 1.0
    assert closed(found, 0.34) == 1.0  # over it by 16 cm: one more than is asked, with noise


@pytest.mark.parametrize("x", [0.36, 0.5, 0.64, -0.5])
def test_a_stone_that_ends_at_a_joint_lets_it_run(x: float) -> None:
    assert closed(joints(STRAIGHT, along_x(-0.5), along_x(0.5)), x) == -1.0


@pytest.mark.parametrize(("x", "z"), [(0.66, 0.75), (2.0, 0.75), (0.0, 0.5)])
def test_a_stone_elsewhere_or_in_the_same_course_does_neither(x: float, z: float) -> None:
    assert closed(joints(STRAIGHT, along_x(-0.5), along_x(0.5)), x, z) == 0.0


def test_stones_that_are_far_apart_or_alone_have_no_joint() -> None:
    assert len(joints(STRAIGHT, along_x(-0.7), along_x(0.7)).along) == 0  # a gap of 40 cm
    assert len(joints(STRAIGHT, along_x(0.0)).along) == 0
    assert closed(joints(STRAIGHT), 0.0) == 0.0


def test_a_joint_that_is_covered_is_none_any_more() -> None:
    assert len(joints(STRAIGHT, along_x(-0.5), along_x(0.5), along_x(0.0, 0.75)).along) == 0


def test_two_joints_of_which_one_is_covered_cancel() -> None:
    found = joints(STRAIGHT, along_x(-1.0), along_x(0.0), along_x(1.0))
    assert found.along == pytest.approx([2.5, 3.5])
    assert closed(found, 0.0) == -1.0  # it ends at both
    assert closed(found, -0.5) == 1.0  # it covers one, and stays clear of the other
    longer = BLOCK.vertices * (1.2, 1.0, 1.0)
    assert found.closed(np.array([[0.0, 0.0, 0.75]]), np.eye(3), longer)[0] == -1.0


def test_joints_of_a_ring_and_across_where_it_closes() -> None:
    def at(angle: float, z: float) -> np.ndarray:
        c, s = np.cos(angle), np.sin(angle)
        R = np.array([[-s, -c, 0.0], [c, -s, 0.0], [0.0, 0.0, 1.0]])
        return pose(R, np.array([2.0 * c, 2.0 * s, z]))

    for middle in (0.0, 1.5):
        found = joints(RING, at(middle - 0.27, 0.25), at(middle + 0.27, 0.25))
        assert len(found.along) == 1, middle
        for turn, value in ((0.0, 1.0), (0.25, -1.0), (1.0, 0.0)):
            T = at(middle + turn, 0.75)
            assert found.closed(T[None, :3, 3], T[:3, :3], BLOCK.vertices)[0] == value, turn


def test_a_cairn_has_none() -> None:
    found = joints(np.zeros((1, 2)), along_x(-0.5), along_x(0.5))
    assert closed(found, 0.0) == 0.0


@pytest.mark.parametrize(("turn_rad", "length_m"), [(0.0, 1.0), (np.pi / 2, 0.6), (np.pi, 1.0)])
def test_a_stone_is_as_long_along_a_wall_as_it_is_turned(turn_rad: float, length_m: float) -> None:
    R, at = about_axis(np.array([0.0, 0.0, 1.0]), turn_rad), np.zeros((2, 3))
    found = joints(STRAIGHT).lengths_m(at, R, BLOCK.vertices)
    assert found == pytest.approx([length_m, length_m])


def test_a_ring_has_lengths_along_its_line_and_a_cairn_has_none() -> None:
    at = np.array([[2.0, 0.0, 0.3], [0.0, 2.0, 0.3]])  # the line runs along y, and along x
    found = joints(RING).lengths_m(at, np.eye(3), BLOCK.vertices)
    assert found == pytest.approx([0.6, 1.0], abs=0.1)
    assert not joints(RING[:1]).lengths_m(at, np.eye(3), BLOCK.vertices).any()


@pytest.mark.parametrize(
    ("x", "z", "left_m"),
    [
        (0.0, 0.25, (0.5, 0.4)),  # between two: to the end of one, and to the beginning of another
        (0.0, 0.75, (2.5, 2.5)),  # none of the second course: to the ends of the wall
        (2.3, 0.25, (0.0, 0.2)),  # what overlaps leaves nothing
        (-2.6, 0.25, (0.0, 0.1)),  # over the end of the wall
    ],
)
def test_what_is_left_of_a_course_beside_a_stone(
    x: float, z: float, left_m: tuple[float, float]
) -> None:
    found = joints(STRAIGHT, along_x(-1.5), along_x(1.4))
    at = np.array([[x, 0.0, z]])
    assert found.left_m(at, np.eye(3), BLOCK.vertices)[0] == pytest.approx(left_m)


def test_a_ring_has_no_end_and_a_cairn_has_no_course() -> None:
    at = np.array([[2.0, 0.0, 0.25]])
    assert np.isinf(joints(RING).left_m(at, np.eye(3), BLOCK.vertices)).all()
    cairn = joints(RING[:1], along_x(0.0))
    assert np.isinf(cairn.left_m(at, np.eye(3), BLOCK.vertices)).all()
    beside = joints(RING, pose(t=np.array([0.0, 2.0, 0.25])))  # a quarter of the ring further on
    before_m, after_m = beside.left_m(at, np.eye(3), BLOCK.vertices)[0]
    assert min(before_m, after_m) == pytest.approx(np.pi - 0.3 - 0.5, abs=0.15)
    assert max(before_m, after_m) == np.inf


def test_no_place_leaves_nothing() -> None:
    none = joints(STRAIGHT, along_x(0.0)).left_m(np.zeros((0, 3)), np.eye(3), BLOCK.vertices)
    assert none.shape == (0, 2)
