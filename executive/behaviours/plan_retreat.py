"""Plan the way up from where the gripper is."""

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.path import PathPlanned
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import surroundings
from executive.messages.request import MoveRequest

_STEP_M = 0.3  # by which a height out of reach is lowered


class PlanRetreatSettings(Settings):
    height: Meters = Field(
        1.5, gt=0, le=5, description="Height to rise [m]; less where the arm does not reach."
    )


class PlanRetreat(Action[PlanRetreatSettings]):
    """Plan a straight way up with the jaws as they are."""

    needs = (MotionPlanner, Mapper, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self) -> Steps[PathPlanned]:
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        cloud, motion = surroundings(self.context), self.context.use(MotionPlanner)
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
            plan = yield from self.context.job(motion.move, request)
            if plan.trajectory is not None:
                return succeeded(PathPlanned(plan.trajectory), f"{height_m:.1f} m up")
            reason = plan.reason
        return failed(f"no path up: {reason}")
