"""Plan how to set a held stone down."""

from collections.abc import Generator
from typing import Any

from pydantic import Field

from executive.config import Meters, Settings
from executive.leaf.action import Action, Steps
from executive.leaf.job import Job
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import held_surface, surroundings
from executive.messages.hold import Hold
from executive.messages.placement import Placement, Slot
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.trajectory import JointTrajectory


class PlanPlacementSettings(Settings):
    leave: Meters = Field(1.0, ge=0, le=5, description="Straight lift before travelling [m].")
    arrive: Meters = Field(1.0, ge=0, le=5, description="Straight way down to the place [m].")


class PlanPlacement(Action):
    """Find the first slot with a placement, and the first placement with a free way to it."""

    Settings = PlanPlacementSettings
    needs = ("placing", "motion", "mapping", "objects")
    inputs = {
        "hold": Port(Hold, "which stone is held, and how"),
        "free_slots": Port(list[Slot], "where it may go, best first"),
    }
    outputs = {
        "placement": Port(Placement, "how it is set down, and where"),
        "trajectory": Port(JointTrajectory, "the way there"),
    }

    def run(self, **inputs: Any) -> Steps:
        hold: Hold = inputs["hold"]
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        stone = self.context.plugin("objects").stone(hold.stone_id)
        cloud = surroundings(self.context, without=hold.stone_id)
        T_map_base = self.context.state().T_map_base
        reasons: list[str] = []
        for slot in inputs["free_slots"]:
            ways = yield self.context.job(
                "placing", "plan", stone, slot, hold.T_map_gripper, cloud, T_map_base
            )
            if not ways:
                reasons.append(f"no placement on slot {slot.id} is in reach")
            for placement in ways:
                plan = yield from self._way_to(placement, hold, cloud)
                if plan.trajectory is not None:
                    self.context.show("path", plan)
                    return succeeded(
                        f"slot {slot.id}", placement=placement, trajectory=plan.trajectory
                    )
                reasons.append(f"slot {slot.id}: {plan.reason}")
        return failed(
            f"no way to any of {len(inputs['free_slots'])} slots: "
            f"{'; '.join(dict.fromkeys(reasons))}"
        )

    def _way_to(
        self, placement: Placement, hold: Hold, cloud: Any
    ) -> Generator[Job, Any, MotionPlan]:
        request = MoveRequest(
            start=self.context.arm(),
            T_map_gripper=placement.T_map_gripper,
            T_map_base=self.context.state().T_map_base,
            leave_m=self.settings.leave,
            arrive_m=self.settings.arrive,
            obstacles=cloud,
            held_gripper=held_surface(self.context, hold),
            jaw_rad=hold.jaw_rad,
        )
        plan: MotionPlan = yield self.context.job("motion", "move", request)
        return plan
