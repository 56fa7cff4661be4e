"""TrialLift, ticked to success and to failure."""

import numpy as np
import pytest

from executive.behaviours.trial_lift import TrialLift
from executive.geometry.pose import pose
from executive.interfaces.motion import MotionPlanner
from executive.messages.command import Follow
from executive.messages.request import MotionPlan
from executive.messages.trajectory import JointTrajectory
from tests.behaviours.placing.scene import NO_PATH, plugins


def planned(stage, world, off_rad=0.0, risen_m=0.0):
    """Let the planner answer a path that ends off the place where the arm stays.

    The gripper is above the grasp by a height.
    """
    T = world.hold.T_map_gripper @ pose()
    T[2, 3] += risen_m
    world.leaf_context.gripper = lambda: T.copy()
    names = world.leaf_context.machine().arm_names
    stay = np.stack([world.leaf_context.arm()] * 2)
    stay[1] += off_rad
    path = JointTrajectory(names, np.array([0.0, 1.0]), stay, np.zeros_like(stay))
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=MotionPlan(path, "", NO_PATH))


def test_it_lifts_by_a_little_from_the_grasp_and_waits(stage, world):
    planned(stage, world)
    began_s = world.leaf_context.time_s
    ended = world.tick(TrialLift, settings={"height": 0.1, "wait": 2.0}, hold=world.hold)
    assert (ended.status, ended.reason) == ("SUCCESS", "it hangs 0.10 m up")
    (asked,) = plugins(world)["motion"].calls("move")
    goal = asked["request"].T_map_gripper
    assert goal[2, 3] == pytest.approx(world.hold.T_map_gripper[2, 3] + 0.1)
    assert goal[:2, 3] == pytest.approx(world.leaf_context.gripper()[:2, 3])
    assert asked["request"].leave_m == pytest.approx(0.1)  # straight up
    assert world.leaf_context.time_s - began_s > 3.0  # the motion, and the wait


def test_a_grip_that_was_raised_meanwhile_is_lifted_by_the_rest_alone(stage, world):
    planned(stage, world, risen_m=0.08)
    assert world.tick(TrialLift, hold=world.hold).status == "SUCCESS"
    (asked,) = plugins(world)["motion"].calls("move")
    assert asked["request"].leave_m == pytest.approx(0.12 - 0.08)


def test_a_stone_that_hangs_higher_already_is_not_lowered(stage, world):
    planned(stage, world, risen_m=0.5)
    ended = world.tick(TrialLift, hold=world.hold)
    assert (ended.status, ended.reason) == ("SUCCESS", "it hangs higher already")
    assert plugins(world)["motion"].calls("move") == []


def test_without_a_path_up_nothing_is_tried_and_that_is_told(stage, world):
    planned(stage, world)
    none = stage.Scripted(MotionPlanner, move=MotionPlan(None, "out of reach", NO_PATH))
    plugins(world)["motion"] = none
    ended = world.tick(TrialLift, hold=world.hold)
    assert (ended.status, ended.reason) == ("SUCCESS", "not tried, no path up: out of reach")
    commands = [one["command"] for one in plugins(world)["robot"].calls("command")]
    assert not any(isinstance(one, Follow) for one in commands)


def test_an_arm_that_does_not_get_up_is_a_failure(stage, world):
    planned(stage, world, off_rad=0.05)
    ended = world.tick(TrialLift, hold=world.hold)
    assert ended.status == "FAILURE"
    assert "off its goal" in ended.reason
