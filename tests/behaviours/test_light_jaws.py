"""Jaws that press so hard that they lift the machine: the gripper is raised, and they go on."""

import numpy as np
import pytest

from executive.behaviours.close_gripper import CloseGripper
from executive.geometry.pose import pose
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.robot import Robot
from executive.leaf.light_jaws import drive_lightly
from executive.messages.command import Follow, MoveJaws
from executive.messages.request import MotionPlan
from executive.messages.trajectory import JointTrajectory

NO_PATH = np.zeros((0, 3))
NO_WAY = MotionPlan(None, "the boom would hit stone 2", NO_PATH)
# In the posture for a scan, 4 m out, these are 0.74 and 0.57 of what holds the machine.
UP_N, ASIDE_N = np.array([0.0, 0.0, 39e3]), np.array([0.0, 50e3, 0.0])
HANGS_N = np.array([0.0, 0.0, -3e3])


@pytest.fixture
def world(stage, database):
    """Return a stage on which every way up is the place itself."""
    stand = stage.Stage(
        robot=stage.Scripted(Robot), mapping=stage.PointMap([[0.0, 0.0, 0.0]]), objects=database
    )
    here = np.stack([stand.leaf_context.arm()] * 2)
    path = JointTrajectory(
        stand.leaf_context.machine().arm_names, np.array([0.0, 1.0]), here, np.zeros_like(here)
    )
    found = MotionPlan(path, "", NO_PATH)
    stand.leaf_context.plugins["motion"] = stage.Scripted(MotionPlanner, move=found)
    stand.leaf_context.jaw = lambda time_s: 0.5
    return stand


def commands(world):
    return [one["command"] for one in world.leaf_context.plugins["robot"].calls("command")]


def press(world, push_n=UP_N, until=float("inf")):
    """Let the jaws press from some ticks on until so many raises, and some weight hang before."""
    world.leaf_context.pushed = lambda time_s: (
        push_n if time_s > 0.2 and raises(world) < until else HANGS_N
    )


def raises(world):
    return sum(isinstance(one, Follow) for one in commands(world))


@pytest.mark.parametrize("push_n", [UP_N, ASIDE_N])
def test_the_gripper_is_raised_until_the_jaws_press_no_more(fakes, world, push_n):
    context = world.leaf_context
    press(world, push_n, until=2)
    leaf = CloseGripper(CloseGripper.Settings(), context)
    leaf.run = lambda: drive_lightly(context, 0.2, 9000.0, 1)
    drive = fakes.finish(leaf)
    assert (drive.angle_rad, drive.is_whole) == (0.5, True)
    assert "raised by 0.10 m, because the jaws pressed so hard" in drive.told
    assert raises(world) == 2
    heights_m = [
        one["request"].T_map_gripper[2, 3] for one in context.plugins["motion"].calls("move")
    ]
    assert heights_m == pytest.approx([context.gripper()[2, 3] + 0.05] * 2)
    jaws = [one for one in commands(world) if isinstance(one, MoveJaws)]
    assert [one.position_rad for one in jaws] == [0.2, 0.5, 0.2, 0.5, 0.2]
    assert {one.force_n for one in jaws} == {9000.0}


@pytest.mark.parametrize(
    ("rolled_rad", "from_rad", "to_rad", "steps"), [(0.0, 0.5, 0.8, 3), (0.6, 0.3, 0.8, 6)]
)
def test_it_is_raised_by_what_the_tips_come_down_and_by_the_depth_of_soil_at_most(
    fakes, world, rolled_rad, from_rad, to_rad, steps
):
    """Jaws that open below a level gripper come up; teeth may be 0.13 m deep in soil."""
    context = world.leaf_context
    press(world)
    context.jaw = lambda time_s: from_rad
    s, c = np.sin(rolled_rad), np.cos(rolled_rad)
    R = np.array([[0.0, 0.0, 1.0], [-s, c, 0.0], [-c, -s, 0.0]])  # x ahead of the jaws is down
    context.gripper = lambda: pose(R=R, t=np.array([5.0, 0.0, 1.5]))
    leaf = CloseGripper(CloseGripper.Settings(), context)
    leaf.run = lambda: drive_lightly(context, to_rad, None, 1)
    drive = fakes.finish(leaf)
    assert (drive.angle_rad, drive.is_whole, raises(world)) == (from_rad, False, steps)
    assert "raised as far as it may be" in drive.told


def test_a_stone_that_is_to_be_carried_is_gripped_all_the_same(stage, world):
    press(world)
    world.leaf_context.plugins["motion"] = stage.Scripted(MotionPlanner, move=NO_WAY)
    ended = world.tick(CloseGripper, stone=1)
    assert ended.status == "SUCCESS"
    assert "(no way up: the boom would hit stone 2), because the jaws pressed" in ended.reason
    assert [one.position_rad for one in commands(world)] == [0.0, 0.5, 0.0]


@pytest.mark.parametrize(
    "push_n",
    [0.4 * UP_N, 0.6 * ASIDE_N, -2 * UP_N],
    ids=["little up", "little aside", "a stone that hangs"],
)
def test_jaws_that_press_little_or_bear_a_weight_go_on(world, push_n):
    press(world, push_n)
    ended = world.tick(CloseGripper, stone=1)
    assert (ended.status, ended.reason, raises(world)) == ("SUCCESS", "", 0)


@pytest.mark.parametrize(("support_n_m", "waits"), [(2e6, True), (None, False)])
def test_a_stone_that_jaws_lift_is_taken_on_in_steps_where_the_machine_sways(
    world, support_n_m, waits
):
    """Held from its supports, 0.6 of what tips it comes to hang at once; half a sway is waited."""
    context = world.leaf_context
    stance = context.machine().stance.model_copy(update={"support_n_m": support_n_m})
    context._machine = context.machine().model_copy(update={"stance": stance})
    press(world, -0.8 * UP_N)
    ended = world.tick(CloseGripper, stone=1)
    assert ended.status == "SUCCESS"
    jaws = [one.position_rad for one in commands(world) if isinstance(one, MoveJaws)]
    assert jaws == ([0.0, 0.5, 0.0] if waits else [0.0])
    assert ended.reason.startswith("the jaws waited 0." if waits else "")


def test_a_robot_without_efforts_presses_on_nothing(world):
    world.leaf_context.pushed = lambda time_s: np.zeros(3)
    ended = world.tick(CloseGripper, stone=1)
    assert (ended.status, ended.reason, raises(world)) == ("SUCCESS", "", 0)
