"""Leave out the places that are taken."""

from typing import Any

from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.port import Port
from executive.messages.placement import Slot
from executive.messages.stone import StoneState

_TAKEN_M = 0.6  # a placed stone whose centre is this near (horizontally) stands on the place


class FindFreeSlots(Condition):
    """List the places on which no placed stone stands; fails when all are taken."""

    needs = ("objects",)
    inputs = {"slots": Port(list[Slot], "places, best first")}
    outputs = {"free_slots": Port(list[Slot], "those that are free, best first")}

    def check(self, **inputs: Any) -> Outcome:
        placed = [
            s for s in self.context.plugin("objects").stones() if s.state is StoneState.PLACED
        ]
        free = []
        for slot in inputs["slots"]:
            gaps = [stone.centroid_map[:2] - slot.position_map[:2] for stone in placed]
            if all((gap @ gap) ** 0.5 > _TAKEN_M for gap in gaps):
                free.append(slot)
        if not free:
            return failed(f"all {len(inputs['slots'])} places are taken")
        return succeeded(f"{len(free)} places are free", free_slots=free)
