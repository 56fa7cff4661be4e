"""PlanSetDown, ticked to success and to failure."""

import numpy as np
import pytest

from executive.behaviours.plan_set_down import PlanSetDown
from executive.interfaces.motion import MotionPlanner
from tests.behaviours.placing.scene import NO_WAY, plugins


def test_a_slipping_stone_is_set_down_on_the_ground_below(stage, world):
    motion = plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=world.found)
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert ended.outputs == {"trajectory": world.path}
    (asked,) = motion.calls("move")
    # The gripper is at 2 m and has risen by 1.5 m since the grasp on the ground.
    z = asked["request"].T_map_gripper[2, 3]
    assert z == pytest.approx(0.5, abs=0.1)
    assert asked["request"].arrive_m == pytest.approx(2.0 - z)


def above_the_other_stone(world):
    """Let the gripper hold stone 1 above stone 2."""
    over = world.leaf_context.gripper()
    over[:2, 3] = 5.0, 3.0
    world.leaf_context.gripper = lambda: over.copy()
    return over


def test_a_slipping_stone_is_set_down_beside_a_stone_that_is_below(stage, world, database):
    over = above_the_other_stone(world)
    motion = plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=world.found)
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert "aside of another stone" in ended.reason
    (asked,) = motion.calls("move")
    goal = asked["request"].T_map_gripper
    held = asked["request"].held_gripper[:, :2] + goal[:2, 3]
    other = database.stone(2).points_map[:, :2]
    apart = np.linalg.norm(held[:, None] - other, axis=-1).min()
    assert 0.3 <= apart < 0.6  # no nearer than is safe, and no farther than is needed
    assert goal[2, 3] == pytest.approx(0.5, abs=0.1)  # on the ground, not on the stone
    assert over[2, 3] == 2.0


def test_a_slipping_stone_is_set_down_on_another_one_where_nothing_else_is_in_reach(stage, world):
    above_the_other_stone(world)
    motion = stage.Scripted(MotionPlanner, move=[NO_WAY] * 4 + [world.found])
    plugins(world)["motion"] = motion
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert "aside" not in ended.reason
    asked = motion.calls("move")
    assert len(asked) == 5
    np.testing.assert_allclose(asked[-1]["request"].T_map_gripper[:2, 3], [5.0, 3.0])


def test_a_stone_is_not_set_down_without_a_path_or_a_gap(world):
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert (ended.status, ended.reason) == (
        "FAILURE",
        "no path down: the boom would hit stone 2",
    )
    low = world.leaf_context.gripper()
    low[2, 3] = 0.5
    world.leaf_context.gripper = lambda: low.copy()
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert (ended.status, ended.reason) == ("FAILURE", "the stone is at the ground already")
