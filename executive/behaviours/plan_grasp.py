"""Plan how to hold a stone."""

from typing import Any

from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.leaf.surroundings import surroundings
from executive.messages.grasp import Grasp, GraspPlan


class PlanGrasp(Action):
    """Plan grasps of one stone on the planning cloud (Mascaro 2020, Sec. 5)."""

    needs = ("grasping", "mapping", "objects")
    inputs = {"stone": Port(int, "id of the stone")}
    outputs = {"grasps": Port(list[Grasp], "grasps, best first")}

    def run(self, **inputs: Any) -> Steps:
        stone = self.context.plugin("objects").stone(inputs["stone"])
        T_map_base = self.context.state().T_map_base
        cloud = surroundings(self.context)
        plan: GraspPlan = yield self.context.job(
            "grasping", "plan", stone, cloud, T_map_base, self.context.rng()
        )
        self.context.note(
            "grasps_planned", stone=stone.id, grasps=len(plan.grasps), refused=dict(plan.refused)
        )
        if not plan.grasps:
            refused = ", ".join(f"{n} {reason}" for reason, n in plan.refused.items())
            return failed(f"no grasp of stone {stone.id}: {refused or 'no hypothesis'}")
        self.context.show("grasp", plan.grasps[0])
        return succeeded(f"{len(plan.grasps)} grasps", grasps=list(plan.grasps))
