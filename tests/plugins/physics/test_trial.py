"""Trials on stones whose measured poses do not quite fit together."""

import numpy as np
from executive_plugins.physics.stone_world import WorldRules
from executive_plugins.physics.trial import Bounds, Trial

from executive.geometry.pose import pose
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
