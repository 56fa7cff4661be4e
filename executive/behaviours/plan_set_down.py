"""Plan to lower a held stone to the ground below it."""

from typing import Any

from executive.geometry.pose import transform
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import gap_below, held_surface, surroundings
from executive.messages.hold import Hold
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.trajectory import JointTrajectory

_CLEARANCE_M = 0.05  # left between the stone and the ground: the model is a few centimetres off
_LEAST_WAY_M = 0.05


class PlanSetDown(Action):
    """Plan the way straight down, for a stone that slips: it falls less far."""

    needs = ("motion", "mapping", "objects")
    inputs = {"hold": Port(Hold, "which stone is held, and how")}
    outputs = {"trajectory": Port(JointTrajectory, "the way down")}

    def run(self, **inputs: Any) -> Steps:
        hold: Hold = inputs["hold"]
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        cloud = surroundings(self.context, without=hold.stone_id)
        surface = held_surface(self.context, hold)
        goal = self.context.gripper()
        way_m = gap_below(transform(goal, surface), cloud.points) - _CLEARANCE_M
        if way_m < _LEAST_WAY_M:
            return failed("the stone is at the ground already")
        goal[2, 3] -= way_m
        request = MoveRequest(
            start=self.context.arm(),
            T_map_gripper=goal,
            T_map_base=self.context.state().T_map_base,
            leave_m=0.0,
            arrive_m=way_m,
            obstacles=cloud,
            held_gripper=surface,
            jaw_rad=hold.jaw_rad,
        )
        plan: MotionPlan = yield self.context.job("motion", "move", request)
        if plan.trajectory is None:
            return failed(f"no way down: {plan.reason}")
        return succeeded(f"{way_m:.2f} m down", trajectory=plan.trajectory)
