"""Choose where the stones are to go."""

from dataclasses import dataclass

from pydantic import Field

from executive.config import Settings
from executive.events.site import SlotPlace, SlotsFound
from executive.interfaces.placing import PlacementPlanner
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.messages.placement import Slot
from executive.messages.segment import Segmentation


class FindSlotsSettings(Settings):
    count: int = Field(7, ge=1, le=50, description="Number of slots wanted.")
    at_least: int = Field(1, ge=1, le=50, description="Fewer slots than this are a failure.")


@dataclass(frozen=True, slots=True)
class SlotList:
    """Slots of the mission.

    Attributes:
        slots: Slots on free ground in reach, best first.
    """

    slots: list[Slot]


class FindSlots(Action[FindSlotsSettings]):
    """Find equally spaced slots on free ground in reach (Mascaro et al. 2020, Sec. 6.1)."""

    needs = (PlacementPlanner,)

    def run(self, segmentation: Segmentation) -> Steps[SlotList]:
        """Ask the placement planner.

        Args:
            segmentation: Ground and objects of the map.
        """
        planner, T_map_base = self.context.use(PlacementPlanner), self.context.state().T_map_base
        slots = yield from self.context.job(
            planner.slots, segmentation, T_map_base, self.settings.count
        )
        places = tuple(SlotPlace(slot.id, slot.position_map) for slot in slots)
        self.context.record(SlotsFound(places))
        for slot in slots:
            self.context.show(f"slots/{slot.id}", slot)
        if len(slots) < self.settings.at_least:
            return failed(
                f"there is free ground for {len(slots)} stones, and {self.settings.at_least} "
                "are wanted"
            )
        return succeeded(SlotList(list(slots)), f"{len(slots)} slots")
