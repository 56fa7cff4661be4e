"""Plan the way up from where the gripper is."""

from collections.abc import Generator
from typing import Any

import numpy as np
from pydantic import Field

from executive.config import Meters, Radians, Settings
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import exp_so3
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.path import PathPlanned
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import surroundings
from executive.messages.request import MotionPlan, MoveRequest

_STEP_M = 0.3  # by which a height out of reach is lowered


class PlanRetreatSettings(Settings):
    height: Meters = Field(
        1.5, gt=0, le=5, description="Height to rise [m]; less where the arm does not reach."
    )
    turn: Radians = Field(
        0.0,
        ge=-3.1,
        le=3.1,
        description="Turn of the cabin at the top [rad]: the beams of lidars that look meanwhile "
        "sweep over what was left below. Left out where it is not free.",
    )


class PlanRetreat(Action[PlanRetreatSettings]):
    """Plan a straight way up with the jaws as they are, and a turn of the cabin at its top."""

    needs = (MotionPlanner, Mapper, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self) -> Steps[PathPlanned]:
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        turns = [self.settings.turn, 0.0] if self.settings.turn else [0.0]
        reason = ""
        for height_m in np.arange(self.settings.height, 0.1, -_STEP_M):
            for turn_rad in turns:
                plan = yield from self._planned(float(height_m), turn_rad)
                if plan.trajectory is not None:
                    turned = f", turned by {np.degrees(turn_rad):.0f}°" if turn_rad else ""
                    return succeeded(PathPlanned(plan.trajectory), f"{height_m:.1f} m up{turned}")
                reason = plan.reason
        return failed(f"no path up: {reason}")

    def _planned(self, height_m: float, turn_rad: float) -> Generator[Any, Any, MotionPlan]:
        obstacles = yield from surroundings(self.context)
        T_map_base = self.context.state().T_map_base
        up = pose(t=np.array([0.0, 0.0, height_m])) @ self.context.gripper()
        turn = pose(R=exp_so3(np.array([0.0, 0.0, turn_rad])))
        request = MoveRequest(
            start=self.context.arm(),
            T_map_gripper=T_map_base @ turn @ inverse(T_map_base) @ up,
            T_map_base=T_map_base,
            leave_m=height_m,
            arrive_m=0.0,
            obstacles=obstacles,
            held_gripper=None,
            jaw_rad=self.context.joints().of(self.context.machine().jaw.name)[0],
        )
        return (yield from self.context.job(self.context.use(MotionPlanner).move, request))
