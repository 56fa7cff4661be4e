"""Choose where the stones are to go."""

from typing import Any

from pydantic import Field

from executive.config import Settings
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.messages.placement import Slot
from executive.messages.segment import Segmentation


class FindSlotsSettings(Settings):
    count: int = Field(7, ge=1, le=50, description="Number of places wanted.")
    at_least: int = Field(1, ge=1, le=50, description="Fewer places than this are a failure.")


class FindSlots(Action):
    """Find equally spaced places on free ground in reach (Mascaro 2020, Sec. 6.1)."""

    Settings = FindSlotsSettings
    needs = ("placing",)
    inputs = {"segmentation": Port(Segmentation, "ground and objects of the map")}
    outputs = {"slots": Port(list[Slot], "free places, best first")}

    def run(self, **inputs: Any) -> Steps:
        slots = yield self.context.job(
            "placing",
            "slots",
            inputs["segmentation"],
            self.context.state().T_map_base,
            self.settings.count,
        )
        self.context.note(
            "slots", slots=[{"slot": s.id, "position_map": s.position_map} for s in slots]
        )
        for slot in slots:
            self.context.show(f"slots/{slot.id}", slot)
        if len(slots) < self.settings.at_least:
            return failed(
                f"free ground for {len(slots)} stones, {self.settings.at_least} are wanted"
            )
        return succeeded(f"{len(slots)} places", slots=list(slots))
