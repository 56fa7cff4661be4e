"""Plan how to set a held stone down."""

from typing import Any

from pydantic import Field

from executive.behaviours.action import Action, Steps
from executive.behaviours.outcome import failed, succeeded
from executive.behaviours.port import Port
from executive.behaviours.surroundings import held_surface, surroundings
from executive.config import Meters, Settings
from executive.messages.hold import Hold
from executive.messages.placement import Placement, Slot
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.trajectory import JointTrajectory


class PlanPlacementSettings(Settings):
    leave: Meters = Field(1.0, ge=0, le=5, description="Straight lift before travelling [m].")
    arrive: Meters = Field(1.0, ge=0, le=5, description="Straight way down to the place [m].")


class PlanPlacement(Action):
    """Find the first placement on a slot with a free way to it."""

    Settings = PlanPlacementSettings
    needs = ("placing", "motion", "mapping", "objects")
    inputs = {"hold": Port(Hold, "which stone is held, and how"), "slot": Port(Slot, "where it is to go")}
    outputs = {
        "placement": Port(Placement, "how it is set down"),
        "trajectory": Port(JointTrajectory, "the way there"),
    }

    def run(self, **inputs: Any) -> Steps:
        hold: Hold = inputs["hold"]
        stone = self.context.plugin("objects").stone(hold.stone_id)
        cloud = surroundings(self.context, without=hold.stone_id)
        T_map_base = self.context.state().T_map_base
        ways = yield self.context.job("placing", "plan", stone, inputs["slot"], hold.T_map_gripper, cloud, T_map_base)
        surface = held_surface(self.context, hold)
        reasons = []
        for placement in ways:
            request = MoveRequest(
                start=self.context.arm(),
                T_map_gripper=placement.T_map_gripper,
                T_map_base=T_map_base,
                leave_m=self.settings.leave,
                arrive_m=self.settings.arrive,
                obstacles=cloud,
                held_gripper=surface,
                jaw_rad=hold.jaw_rad,
            )
            plan: MotionPlan = yield self.context.job("motion", "move", request)
            if plan.trajectory is not None:
                self.context.show("path", plan)
                return succeeded(placement=placement, trajectory=plan.trajectory)
            reasons.append(plan.reason)
        why = "; ".join(sorted(set(reasons))) or "no placement is in reach"
        return failed(f"no way to slot {inputs['slot'].id}: {why}")
