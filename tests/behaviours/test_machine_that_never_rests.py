"""A leaf that plans from where the arm is fails where the machine does not come to rest."""

import numpy as np
import pytest

from executive.behaviours.go_to_posture import GoToPosture
from executive.behaviours.lower_until_down import LowerUntilDown
from executive.behaviours.plan_pick import PlanPick
from executive.behaviours.plan_retreat import PlanRetreat
from executive.behaviours.scan_swing import ScanSwing
from executive.behaviours.some_stone_placed import SomeStonePlaced
from executive.geometry.pose import pose
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.messages.grasp import Grasp
from executive.messages.hold import Hold
from executive.messages.placement import Placement, Slot

HOLD = Hold(1, pose(t=np.array([5.0, 0.0, 1.0])), 0.6)
PLACED = Placement(Slot(1, np.array([5.0, 0.0, 0.0])), HOLD.T_map_gripper, np.eye(4))
GRASPS = [Grasp(HOLD.T_map_gripper, 1.2, 0.5, {"slip_m": 0.1})]


@pytest.mark.parametrize(
    ("leaf", "settings", "inputs"),
    [
        (PlanRetreat, {}, {}),
        (PlanPick, {}, {"stone": 1, "grasps": GRASPS}),
        (LowerUntilDown, {}, {"hold": HOLD, "placement": PLACED}),
        (ScanSwing, {}, {}),
        (GoToPosture, {"posture": "scan"}, {"hold": None}),
    ],
)
def test_nothing_is_planned_for_an_arm_that_moves_on(stage, database, leaf, settings, inputs):
    robot, planner = stage.Scripted(Robot), stage.Scripted(MotionPlanner)
    world = stage.Stage(
        robot=robot,
        motion=planner,
        objects=database,
        mapping=stage.PointMap(np.zeros((1, 3))),
    )
    context = world.leaf_context
    start, count = context.arm(), len(context.machine().arm_names)
    context.positions = lambda time_s: start + 0.2 * time_s
    context.velocities = lambda time_s: np.full(count, 0.2)
    ended = world.tick(leaf, settings=settings, **inputs)
    assert ended.status == "FAILURE"
    assert "still moves" in ended.reason
    assert planner.asked == []
    assert not [one for one in robot.asked if one[0] == "command"]


def test_without_a_known_stone_none_is_placed(stage):
    ended = stage.Stage(objects=stage.Scripted(ObjectDatabase, stones=())).tick(SomeStonePlaced)
    assert (ended.status, ended.reason) == ("FAILURE", "no stone is known, so none is placed")
