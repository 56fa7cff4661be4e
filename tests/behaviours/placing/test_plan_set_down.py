"""PlanSetDown, ticked to success and to failure."""

import numpy as np
import pytest

from executive.behaviours.plan_set_down import PlanSetDown
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.interfaces.motion import MotionPlanner
from executive.leaf.tool_way import tool_way
from executive.messages.hold import Hold
from executive.messages.request import MotionPlan
from executive.messages.trajectory import JointTrajectory
from executive.messages.weight import Weight
from tests.behaviours.placing.scene import NO_PATH, NO_WAY, plugins


def test_a_slipping_stone_is_set_down_on_the_ground_below(stage, world):
    motion = plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=world.found)
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert ended.status == "SUCCESS"
    np.testing.assert_array_equal(ended.outputs["trajectory"].position[-1], world.path.position[-1])
    (asked,) = motion.calls("move")
    # The gripper is at 2 m and has risen by 1.5 m since the grasp on the ground.
    z = asked["request"].T_map_gripper[2, 3]
    assert z == pytest.approx(0.5, abs=0.1)
    assert asked["request"].arrive_m == pytest.approx(2.0 - z)


@pytest.mark.parametrize(("unseen_m", "counts_m"), [(-0.1, 0.0), (0.1, 0.1), (0.4, 0.15)])
def test_what_nobody_saw_of_the_underside_stands_on_the_ground_sooner(
    stage, world, database, unseen_m, counts_m
):
    """It stood as it was grasped: what its model lacks down to the ground is a part of it."""
    motion = plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=world.found)
    whole = world.tick(PlanSetDown, hold=world.hold)
    database.realign(1, pose(t=np.array([0.0, 0.0, unseen_m])), 1.0, "its lower part is not seen")
    cut = world.tick(PlanSetDown, hold=world.hold)
    assert (whole.status, cut.status) == ("SUCCESS", "SUCCESS")
    whole_m, cut_m = (one["request"].T_map_gripper[2, 3] for one in motion.calls("move"))
    assert whole_m - cut_m == pytest.approx(unseen_m - counts_m)


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


@pytest.mark.parametrize("may_tip", [False, True])
def test_the_way_down_is_slow_where_a_stone_that_has_turned_may_stand(stage, world, may_tip):
    """Held by the middle of its sides, with 0.8 m to the farthest corner, 0.35 m below the tips."""
    context = world.leaf_context
    if may_tip:
        on_legs(world)
    machine = context.machine()
    R = from_rpy(0.0, np.pi / 2, 0.0)  # the palm looks down
    hold = Hold(1, pose(R, np.array([5.0, 0.0, 1.4])), 0.6)
    context.gripper = lambda: pose(R, np.array([5.0, 0.0, 2.9]))
    stamps = np.linspace(0.0, 2.0, 101)
    position = np.tile(context.arm(), (len(stamps), 1))
    u = stamps / 2.0
    position[:, machine.arm_names.index("J_BOOM")] -= 0.4 * (3 * u**2 - 2 * u**3)
    fast = JointTrajectory(
        machine.arm_names, stamps, position, np.gradient(position, stamps, axis=0)
    )
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=MotionPlan(fast, "", NO_PATH))
    planned = world.tick(PlanSetDown, hold=hold).outputs["trajectory"]
    way_m = tool_way(machine, planned)
    speed, left_m = np.diff(way_m) / np.diff(planned.times_s), way_m[-1] - way_m[1:]
    assert speed.max() > 0.5
    assert speed[left_m < 0.15].max() == pytest.approx(0.3, rel=0.05)
    before, step_s = speed[left_m > 0.15], np.diff(planned.times_s)[0]
    braking_m_s2 = (before[:-10] - before[10:]).max() / (10 * step_s)
    assert braking_m_s2 < (0.3 if may_tip else 0.6)
    assert planned.duration_s > fast.duration_s


@pytest.mark.parametrize(("mass_kg", "asked"), [(500.0, 1), (2900.0, 5)])
def test_a_stone_is_not_carried_aside_beyond_the_lift_capacity(
    stage, world, database, mass_kg, asked
):
    """Aside of the other stone the arm would swing out to 6 m at the side."""
    machine = on_legs(world)
    far = dict(zip(machine.arm_names, machine.posture("carry"), strict=True))
    far |= {"J_TURN": 1.57, "J_BOOM": 0.75, "J_DIPPER": 0.3, "J_TELE": 1.2, "J_EE_PITCH": -1.19}
    position = np.stack([machine.posture("carry"), [*far.values()]])
    way = JointTrajectory(machine.arm_names, np.array([0.0, 9.0]), position, 0 * position)
    above_the_other_stone(world)
    aside = [MotionPlan(way, "", NO_PATH)] * 4
    motion = stage.Scripted(MotionPlanner, move=[*aside, world.found])
    plugins(world)["motion"] = motion
    database.weigh(1, Weight(mass_kg, 20.0), 3.0)
    ended = world.tick(PlanSetDown, hold=world.hold)
    assert ended.status == "SUCCESS"
    assert len(motion.calls("move")) == asked
    assert ("aside" in ended.reason) == (asked == 1)


def on_legs(world):
    """Let the machine stand so that it may tip."""
    machine = world.leaf_context.machine()
    stance = machine.stance.model_copy(update={"is_free": True, "support_n_m": 2e6})
    freed = machine.model_copy(update={"stance": stance})
    world.leaf_context.machine = lambda: freed
    return freed
