"""A stage on which a stone is held, and one on which a stone has moved."""

import numpy as np
import pytest

from executive.geometry.pose import pose
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.robot import Robot
from executive.messages.hold import Hold
from executive.messages.request import MotionPlan
from executive.messages.trajectory import JointTrajectory
from tests.behaviours.placing.scene import NO_PATH, NO_WAY


@pytest.fixture
def world(stage, database):
    """Return a stage on which stone 1 is held 1.5 m above flat ground, below the gripper."""
    grid = np.stack(np.meshgrid(np.arange(0, 9, 0.1), np.arange(-5, 5, 0.1)), -1).reshape(-1, 2)
    stand = stage.Stage(
        robot=stage.Scripted(Robot),
        mapping=stage.PointMap(np.column_stack([grid, np.zeros(len(grid))])),
        objects=database,
        motion=stage.Scripted(MotionPlanner, move=NO_WAY),
    )
    context = stand.leaf_context
    T_at_grasp = pose(t=np.array([5.0, 0.0, 0.5]))
    database.grasp(1, T_at_grasp, 2.0)
    stand.hold = Hold(1, T_at_grasp, 0.6)
    start = context.arm()
    position = np.stack([start, start + 0.1])
    stand.path = JointTrajectory(
        context.machine().arm_names, np.array([0.0, 1.0]), position, np.zeros_like(position)
    )
    stand.found = MotionPlan(stand.path, "", NO_PATH)
    return stand
