"""Plan the way to a grasp."""

from typing import Any

from pydantic import Field

from executive.behaviours.action import Action, Steps
from executive.behaviours.outcome import failed, succeeded
from executive.behaviours.port import Port
from executive.behaviours.surroundings import surroundings
from executive.config import Meters, Settings
from executive.messages.grasp import Grasp
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.trajectory import JointTrajectory


class PlanPickSettings(Settings):
    leave: Meters = Field(0.5, ge=0, le=5, description="Straight way up before travelling [m].")
    arrive: Meters = Field(1.2, ge=0, le=5, description="Straight way to the grasp along the ground's normal [m].")


class PlanPick(Action):
    """Find the first grasp with a free way to it; it and those before it are taken off the list."""

    Settings = PlanPickSettings
    needs = ("motion", "mapping", "objects")
    inputs = {"stone": Port(int, "id of the stone"), "grasps": Port(list[Grasp], "grasps, best first")}
    outputs = {
        "grasp": Port(Grasp, "the grasp that the way leads to"),
        "grasps": Port(list[Grasp], "the grasps that are left for another try"),
        "trajectory": Port(JointTrajectory, "the way to the grasp"),
    }

    def run(self, **inputs: Any) -> Steps:
        grasps: list[Grasp] = inputs["grasps"]
        stone = self.context.plugin("objects").stone(inputs["stone"])
        cloud = surroundings(self.context)
        reasons = []
        for number, grasp in enumerate(grasps, 1):
            plan: MotionPlan = yield self.context.job("motion", "move", self._request(grasp, cloud))
            if plan.trajectory is None:
                reasons.append(plan.reason)
                continue
            self.context.note(
                "attempt", stone=stone.id, centroid_map=stone.centroid_map, grasp=_as_record(grasp), passed_over=reasons
            )
            self.context.show("grasp", grasp)
            self.context.show("path", plan)
            return succeeded(grasp=grasp, grasps=grasps[number:], trajectory=plan.trajectory)
        why = "; ".join(sorted(set(reasons))) or "no grasp is left"
        return failed(f"no way to any of {len(grasps)} grasps of stone {stone.id}: {why}", grasps=[])

    def _request(self, grasp: Grasp, cloud: Any) -> MoveRequest:
        return MoveRequest(
            start=self.context.arm(),
            T_map_gripper=grasp.T_map_gripper,
            T_map_base=self.context.state().T_map_base,
            leave_m=self.settings.leave,
            arrive_m=self.settings.arrive,
            obstacles=cloud,
            held_gripper=None,
            jaw_rad=self.context.machine().gripper.open_rad,
        )


def _as_record(grasp: Grasp) -> dict[str, Any]:
    return {
        "T_map_gripper": grasp.T_map_gripper,
        "opening_m": grasp.opening_m,
        "score": grasp.score,
        "costs": dict(grasp.costs),
    }
