"""The push and the closing against brute force."""

import numpy as np
import pytest
from executive_plugins.grasping.sampling.closing import (
    Clearance,
    HoldOutcome,
    Holds,
    Hypotheses,
    push_and_close,
)
from executive_plugins.grasping.sampling.frames import downward_frames
from executive_plugins.grasping.sampling.jaw_field import NEVER, JawField, build_jaw_field

from executive.arrays import Float
from executive.geometry.convex import depth_inside, half_spaces
from executive.geometry.rotation import exp_so3
from executive.machine.gripper import Gripper

CELL_M = 0.03
DOWN = downward_frames(np.zeros(1))  # the jaws open along x
NO_ROOM = Clearance(0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def tables(gripper: Gripper) -> JawField:
    return build_jaw_field(gripper, CELL_M, 0.0)


def block(half_x: float = 0.5, half_y: float = 0.5, height: float = 0.7) -> Float:
    x, y, z = (np.arange(-h, h + 1e-9, 0.02) for h in (half_x, half_y, height / 2))
    grid = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    grid = grid[(np.abs(grid) > np.array([half_x, half_y, height / 2]) - 0.03).any(axis=1)]
    return np.asarray(grid + (0, 0, height / 2))


def ground(half: float = 2.0) -> Float:
    x = np.arange(-half, half, 0.04)
    xy = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.column_stack([xy, np.zeros(len(xy))])


def close(
    tables: JawField,
    stone: Float,
    others: Float,
    R: Float = DOWN,
    centred: bool = False,
    clearance: Clearance = NO_ROOM,
) -> Holds:
    points = np.concatenate([stone, others])
    tried = Hypotheses(R, np.tile(stone.mean(axis=0), (len(R), 1)), np.full(len(R), centred))
    is_target = np.arange(len(points)) < len(stone)
    return push_and_close(tables, points, is_target, stone.mean(axis=0), tried, clearance)


def test_the_push_stops_where_brute_force_first_touches(tables: JawField, gripper: Gripper) -> None:
    """The tables are on the safe side by about a cell, more where a face is steep: never deeper,
    hardly shallower.
    """
    rng = np.random.default_rng(3)
    stone = rng.normal(0, 0.25, (400, 3)) + (0, 0, 0.6)
    faces = [
        half_spaces(hull) for parts in gripper.hulls(gripper.open_rad).values() for hull in parts
    ]
    for _ in range(5):
        R = DOWN @ exp_so3(rng.normal(0, 0.2, 3))
        holds = close(tables, stone, np.empty((0, 3)), R)
        if holds.outcome[0] == HoldOutcome.NOTHING_TOUCHED:
            continue
        depths = np.arange(-0.3, 0.31, 0.01)

        def deepest(depth: float, R: Float = R, holds: Holds = holds) -> float:
            local = (stone - holds.position[0] - depth * R[0, :, 0]) @ R[0]
            return max(float(depth_inside(f, local).max()) for f in faces)

        first = next(depth for depth in depths if deepest(depth) > 0)
        assert -0.001 <= first <= 0.15
        assert deepest(0.0) <= 1e-6


def test_a_block_is_held_from_above_by_both_jaws(tables: JawField) -> None:
    holds = close(tables, block(), ground())
    assert holds.outcome[0] == HoldOutcome.HELD
    opening = 2 * tables.tip_b[holds.progress[0]]
    np.testing.assert_allclose(
        opening, 1.0, atol=0.2
    )  # the width of the block, the jaws' thickness apart
    assert holds.contact[0, 0, 1] == pytest.approx(0.5, abs=0.05)
    assert holds.contact[0, 1, 1] == pytest.approx(-0.5, abs=0.05)


def test_tips_stay_above_the_ground_on_their_whole_arc(tables: JawField, gripper: Gripper) -> None:
    holds = close(tables, block(), ground(), clearance=Clearance(0.0, 0.05, 0.0))
    for k in range(int(holds.progress[0].max()) + 1):
        tips = holds.position[0] + gripper.tips(float(tables.jaw_rad[k])) @ DOWN[0].T
        assert tips[:, 2].min() >= 0.05 - 1e-6


def test_without_ground_the_gripper_comes_as_deep_as_the_palm_allows(tables: JawField) -> None:
    holds = close(tables, block(), np.empty((0, 3)))
    assert holds.position[0, 2] == pytest.approx(0.7, abs=0.08)


def test_nothing_below_is_nothing_touched(tables: JawField) -> None:
    stone = block() + (9.0, 0.0, 0.0)
    tried = Hypotheses(DOWN, np.zeros((1, 3)), np.zeros(1, dtype=bool))
    holds = push_and_close(
        tables, stone, np.ones(len(stone), dtype=bool), stone.mean(axis=0), tried, NO_ROOM
    )
    assert holds.outcome[0] == HoldOutcome.NOTHING_TOUCHED


def test_a_stone_beside_the_jaws_is_not_between_them(tables: JawField) -> None:
    stone = block(0.2, 0.2, 0.4)
    tried = Hypotheses(DOWN, np.array([[0.0, 0.8, 0.0]]), np.zeros(1, dtype=bool))
    points = np.concatenate([stone, ground()])
    holds = push_and_close(
        tables, points, np.arange(len(points)) < len(stone), stone.mean(axis=0), tried, NO_ROOM
    )
    assert holds.outcome[0] == HoldOutcome.NOTHING_BETWEEN_JAWS


def test_a_stone_wider_than_the_opening_is_not_held(tables: JawField) -> None:
    holds = close(tables, block(1.4, 1.4, 0.7), ground(2.5))
    assert holds.outcome[0] != HoldOutcome.HELD


def test_a_flat_plate_on_the_ground_leaves_the_tips_too_high(tables: JawField) -> None:
    holds = close(tables, block(0.5, 0.5, 0.1), ground(), clearance=Clearance(0.0, 0.06, 0.02))
    assert holds.outcome[0] == HoldOutcome.TIPS_TOO_HIGH


def test_a_neighbour_where_the_jaw_closes_makes_the_gripper_stay_higher(tables: JawField) -> None:
    free = close(tables, block(), ground())
    neighbour = block(0.1, 0.3, 0.5) + (0.9, 0.0, 0.0)
    blocked = close(tables, block(), np.concatenate([ground(), neighbour]))
    assert blocked.position[0, 2] > free.position[0, 2] + 0.2


def test_a_neighbour_at_0_3_m_behind_the_width_changes_nothing(tables: JawField) -> None:
    free = close(tables, block(0.5, 0.3, 0.7), ground())
    neighbour = block(0.5, 0.3, 0.7) + (0.0, 0.9, 0.0)
    beside = close(tables, block(0.5, 0.3, 0.7), np.concatenate([ground(), neighbour]))
    assert beside.outcome[0] == HoldOutcome.HELD
    np.testing.assert_allclose(beside.position, free.position, atol=1e-9)


def test_a_centred_hypothesis_moves_to_the_middle_between_the_jaws(tables: JawField) -> None:
    stone, half = block(), np.zeros(1, dtype=bool)
    points = np.concatenate([stone, ground()])
    is_target = np.arange(len(points)) < len(stone)
    aside = np.array([[0.15, 0.0, 0.0]])
    for is_centred, x in ((half, 0.15), (~half, 0.0)):
        holds = push_and_close(
            tables,
            points,
            is_target,
            stone.mean(axis=0),
            Hypotheses(DOWN, aside, is_centred),
            NO_ROOM,
        )
        assert holds.position[0, 0] == pytest.approx(x, abs=1e-6)


def test_order_of_the_points_does_not_matter(tables: JawField) -> None:
    stone, others = block(), ground()
    points, is_target = (
        np.concatenate([stone, others]),
        np.arange(len(stone) + len(others)) < len(stone),
    )
    order = np.random.default_rng(0).permutation(len(points))
    tried = Hypotheses(DOWN, np.zeros((1, 3)), np.zeros(1, dtype=bool))
    a = push_and_close(tables, points, is_target, np.zeros(3), tried, NO_ROOM)
    b = push_and_close(tables, points[order], is_target[order], np.zeros(3), tried, NO_ROOM)
    np.testing.assert_allclose(a.position, b.position)
    np.testing.assert_array_equal(a.progress, b.progress)


def test_a_single_stray_point_of_the_stone_is_no_touch(tables: JawField) -> None:
    clean = close(tables, block(), ground())
    stray = np.concatenate([block(), [[0.8, 0.0, 0.3]]])
    noisy = close(tables, stray, ground())
    assert noisy.progress[0, 0] == pytest.approx(clean.progress[0, 0], abs=1)
    assert NEVER not in noisy.progress
