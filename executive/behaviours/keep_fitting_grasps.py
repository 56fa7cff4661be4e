"""Keep the grasps with which a stone can be set down where it is to go."""

from dataclasses import dataclass

from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.placing import PlacementPlanner
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.surroundings import surroundings
from executive.messages.grasp import Grasp
from executive.messages.placement import Slot


@dataclass(frozen=True, slots=True)
class FittingGrasps:
    """Grasps that suit a place.

    Attributes:
        fitting: Those with a placement on one of the slots, best first.
    """

    fitting: list[Grasp]


class KeepFittingGrasps(Action):
    """Leave out grasps with which no slot takes the stone: jaws that would meet a neighbour of the
    place, or a pose of the gripper out of reach there.

    Fails when none is left.
    """

    needs = (PlacementPlanner, Mapper, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self, stone: int, grasps: list[Grasp], free_slots: list[Slot]) -> Steps[FittingGrasps]:
        """Ask the placement planner about each grasp.

        Args:
            stone: Id of the stone.
            grasps: Its grasps, best first.
            free_slots: Where it may go, best first.
        """
        known = self.context.use(ObjectDatabase).stone(stone)
        placing = self.context.use(PlacementPlanner)
        cloud = yield from surroundings(self.context, stone)
        T_map_base = self.context.state().T_map_base
        kept = []
        for grasp in grasps:
            for slot in free_slots:
                placements = yield from self.context.job(
                    placing.plan, known, slot, grasp.T_map_gripper, cloud, T_map_base
                )
                if placements:
                    kept.append(grasp)
                    break
        if not kept:
            return failed(
                f"none of {len(grasps)} grasps of stone {stone} sets it down on any of "
                f"{len(free_slots)} slots: the jaws meet a neighbour, or the place is out of reach"
            )
        return succeeded(FittingGrasps(kept), f"{len(kept)} of {len(grasps)} grasps")
