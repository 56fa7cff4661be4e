"""Trials on stones whose measured poses do not quite fit together."""

import numpy as np
from executive_plugins.physics.stone_world import WorldRules
from executive_plugins.physics.trial import Trial

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
