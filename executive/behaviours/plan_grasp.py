"""Plan how to hold a stone."""

from dataclasses import dataclass

from executive.events.stone import GraspsPlanned
from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.surroundings import surroundings
from executive.messages.grasp import Grasp
from executive.messages.stone import StoneState


@dataclass(frozen=True, slots=True)
class Grasps:
    """Grasps of one stone.

    Attributes:
        grasps: Grasps, best first.
    """

    grasps: list[Grasp]


class PlanGrasp(Action):
    """Plan grasps of one stone on the planning cloud (Mascaro et al. 2020, Sec. 5)."""

    needs = (GraspPlanner, Mapper, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self, stone: int) -> Steps[Grasps]:
        """Ask the grasp planner; a stone that it can never hold is a final failure.

        Args:
            stone: Id of the stone.
        """
        known = self.context.use(ObjectDatabase).stone(stone)
        if known.state is StoneState.LOST:
            return failed(f"stone {stone} is lost: nobody knows where to grasp it")
        around = yield from surroundings(self.context)
        plan = yield from self.context.job(
            self.context.use(GraspPlanner).plan,
            known,
            around,
            self.context.state().T_map_base,
            self.context.rng(),
        )
        self.context.record(GraspsPlanned(stone, len(plan.grasps), dict(plan.refused)))
        if not plan.grasps:
            refused = ", ".join(f"{n} {reason}" for reason, n in plan.refused.items())
            figures = f" ({plan.detail})" if plan.detail else ""
            reason = f"no grasp of stone {stone}: {refused or 'no hypothesis'}{figures}"
            return failed(reason, is_final=plan.is_final)
        self.context.show("grasp", plan.grasps[0])
        return succeeded(Grasps(list(plan.grasps)), f"{len(plan.grasps)} grasps")
