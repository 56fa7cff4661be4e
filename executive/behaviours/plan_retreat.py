"""Plan the way up from where the gripper stands."""

from typing import Any

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import surroundings
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.trajectory import JointTrajectory

_STEP_M = 0.3  # by which a height out of reach is lowered


class PlanRetreatSettings(Settings):
    height: Meters = Field(
        1.5, gt=0, le=5, description="How far up [m]; less where the arm does not reach."
    )


class PlanRetreat(Action):
    """Plan a straight way up, the jaws as they stand."""

    Settings = PlanRetreatSettings
    needs = ("motion", "mapping", "objects")
    outputs = {"trajectory": Port(JointTrajectory, "the way up")}

    def run(self, **inputs: Any) -> Steps:
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        cloud = surroundings(self.context)
        reason = ""
        for height_m in np.arange(self.settings.height, 0.1, -_STEP_M):
            goal = self.context.gripper()
            goal[2, 3] += height_m
            request = MoveRequest(
                start=self.context.arm(),
                T_map_gripper=goal,
                T_map_base=self.context.state().T_map_base,
                leave_m=float(height_m),
                arrive_m=0.0,
                obstacles=cloud,
                held_gripper=None,
                jaw_rad=self.context.joints().of(self.context.machine().jaw.name)[0],
            )
            plan: MotionPlan = yield self.context.job("motion", "move", request)
            if plan.trajectory is not None:
                return succeeded(f"{height_m:.1f} m up", trajectory=plan.trajectory)
            reason = plan.reason
        return failed(f"no way up: {reason}")
