"""Trials on stones whose measured poses do not quite fit together."""

import numpy as np
import pytest
from executive_plugins.physics.stone_world import WorldRules
from executive_plugins.physics.trial import Bounds, Trial, apart, disturbed

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy, log_so3
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.height_grid import HeightGrid
from executive.testing.exercises.building import bare, box


def test_a_stone_that_was_measured_within_the_ground_is_not_thrown_out_of_it() -> None:
    rng = np.random.default_rng(0)
    ground = HeightGrid(np.array([-4.0, -4.0]), 0.25, rng.normal(0.0, 0.03, (33, 33)))
    sunk = StandingStone(box("sunk", 1.6, 1.4, 0.6), pose(t=np.array([-1.0, 0.0, 0.20])))
    built = AsBuilt(bare().structure, ground, (sunk,))
    trial = Trial(built, box("next", 0.8, 0.6, 0.4), WorldRules(step_s=0.005, pieces=1))
    outcome = trial.release(pose(t=np.array([0.9, 0.0, 0.25])), 0.02)
    assert outcome.is_at_rest
    assert outcome.moved_m < 0.01
    at = trial.poses()[0][:3, 3]
    np.testing.assert_allclose(at[:2], [-1.0, 0.0], atol=0.1)
    assert 0.25 < at[2] < 0.4  # on the ground: half of its height, and the bumps


def on_a_box() -> Trial:
    below = StandingStone(box("below", 0.9, 0.7, 0.4), pose(t=np.array([0.0, 0.0, 0.2])))
    built = bare().with_standing(below)
    return Trial(built, box("next", 0.9, 0.6, 0.3), WorldRules(step_s=0.005, pieces=1))


def test_a_release_ends_when_the_stone_is_past_its_bounds() -> None:
    trial, over_the_edge = on_a_box(), pose(t=np.array([0.6, 0.0, 0.56]))
    whole = trial.release(over_the_edge, 0.02)
    took_s = trial.world.data.time
    short = trial.release(over_the_edge, 0.02, Bounds(over_the_edge, 0.1, 0.2))
    assert trial.world.data.time < took_s
    assert not short.is_at_rest
    assert not Bounds(over_the_edge, 0.1, 0.2).holds(whole.T_map_settled)


def test_bounds_that_a_stone_keeps_change_nothing() -> None:
    trial, on_top = on_a_box(), pose(t=np.array([0.05, 0.0, 0.56]))
    free = trial.release(on_top, 0.02)
    kept = trial.release(on_top, 0.02, Bounds(on_top, 0.1, 0.2))
    np.testing.assert_array_equal(kept.T_map_settled, free.T_map_settled)
    assert kept.is_at_rest


def test_faces_closer_than_shapes_are_true_touch() -> None:
    trial = on_a_box()
    for gap_m, is_touch in ((0.003, True), (0.02, False)):
        trial.world.set_pose(1, pose(t=np.array([0.0, 0.0, 0.55 + gap_m])))
        assert bool(trial.touches()) == is_touch
    assert not trial.world.model.geom_margin.any()


def test_a_stone_is_let_go_at_a_height_above_its_first_touch() -> None:
    """It is lowered or raised to where it is just free, to steps of some millimetres."""
    for begin_m in (0.3, 0.56, 1.2):  # within the box below, just above it, and far above
        outcome = on_a_box().release(pose(t=np.array([0.05, 0.0, begin_m])), 0.03)
        assert outcome.is_at_rest
        assert 0.57 < outcome.T_map_release[2, 3] < 0.60  # 0.4 m, half of 0.3 m, and 3 cm
        np.testing.assert_allclose(outcome.T_map_release[:2, 3], [0.05, 0.0])
        np.testing.assert_allclose(outcome.T_map_settled[:3, 3], [0.05, 0.0, 0.55], atol=0.01)
        assert outcome.moved_m < 0.01


def test_a_trial_begins_anew_and_tells_where_all_stones_are() -> None:
    trial, over_the_edge = on_a_box(), pose(t=np.array([0.6, 0.0, 0.56]))
    first = trial.release(over_the_edge, 0.02)
    again = trial.release(over_the_edge, 0.02)
    np.testing.assert_array_equal(again.T_map_settled, first.T_map_settled)
    places = trial.poses()
    assert len(places) == 2
    np.testing.assert_allclose(places[0][:3, 3], [0.0, 0.0, 0.2], atol=0.02)
    np.testing.assert_array_equal(places[1], again.T_map_settled)


def test_what_is_fixed_does_not_move_whatever_falls_on_it() -> None:
    below = StandingStone(box("below", 0.3, 0.3, 0.4), pose(t=np.array([0.0, 0.0, 0.2])))
    rules = WorldRules(step_s=0.005, pieces=1)
    built, heavy = bare().with_standing(below), box("next", 1.6, 1.2, 0.8)
    drop = pose(t=np.array([0.55, 0.0, 0.82]))
    outcome = Trial(built, heavy, rules, fixed=[True]).release(drop, 0.1)
    assert outcome.moved_m == 0.0
    assert Trial(built, heavy, rules, fixed=[False]).release(drop, 0.1).moved_m > 1e-4


def test_noise_on_a_pose_is_level_and_about_all_axes() -> None:
    T, rng = pose(t=np.array([1.0, 2.0, 3.0])), np.random.default_rng(0)
    drawn = [disturbed(T, 0.1, 0.02, rng) for _ in range(2000)]
    moved = np.array([one[:3, 3] for one in drawn]) - T[:3, 3]
    np.testing.assert_allclose(moved.std(axis=0), [0.1, 0.1, 0.0], atol=0.005)
    turned = np.array([log_so3(one[:3, :3]) for one in drawn])
    np.testing.assert_allclose(turned.std(axis=0), 0.02, atol=0.001)
    np.testing.assert_array_equal(T, pose(t=np.array([1.0, 2.0, 3.0])))


def test_bounds_hold_up_to_a_distance_and_an_angle() -> None:
    bounds = Bounds(pose(t=np.array([1.0, 0.0, 0.0])), 0.1, 0.2)
    for away_m, turn_rad, share, holds in (
        (0.09, 0.19, 1.0, True),
        (0.11, 0.0, 1.0, False),
        (0.0, 0.21, 1.0, False),
        (0.14, 0.29, 1.5, True),
        (0.16, 0.0, 1.5, False),
    ):
        T = pose(from_rpy(0.0, 0.0, turn_rad), np.array([1.0 + away_m, 0.0, 0.0]))
        assert bounds.holds(T, share) is holds
        assert apart(bounds.T_map_stone, T) == pytest.approx((away_m, turn_rad))
