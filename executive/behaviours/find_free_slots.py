"""Leave out the slots that are taken."""

from dataclasses import dataclass

from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.placement import Slot
from executive.messages.stone import StoneState

_TAKEN_M = 0.6  # a placed stone whose centroid is this near (horizontally) takes the slot


@dataclass(frozen=True, slots=True)
class FreeSlots:
    """Slots for the next stone.

    Attributes:
        free_slots: Slots on which no placed stone stands, best first.
    """

    free_slots: list[Slot]


class FindFreeSlots(Condition):
    """List the slots on which no placed stone stands; fail when all are taken."""

    needs = (ObjectDatabase,)

    def check(self, slots: list[Slot]) -> Outcome[FreeSlots]:
        """Compare the slots with the placed stones.

        Args:
            slots: All slots of the mission, best first.
        """
        stones = self.context.use(ObjectDatabase).stones()
        placed = [stone for stone in stones if stone.state is StoneState.PLACED]
        free = []
        for slot in slots:
            gaps = [stone.centroid_map[:2] - slot.position_map[:2] for stone in placed]
            if all((gap @ gap) ** 0.5 > _TAKEN_M for gap in gaps):
                free.append(slot)
        if not free:
            return failed(f"all {len(slots)} slots are taken")
        return succeeded(FreeSlots(free), f"{len(free)} slots are free")
