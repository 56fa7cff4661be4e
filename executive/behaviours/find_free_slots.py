"""Leave out the slots that are taken."""

from collections.abc import Sequence
from dataclasses import dataclass

from executive.geometry.polygon import contains
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.messages.placement import Slot
from executive.messages.stone import Stone, StoneState


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
    on_resume = OnResume.REDO

    def check(self, slots: list[Slot]) -> Outcome[FreeSlots]:
        """Compare the slots with the placed stones.

        Args:
            slots: All slots of the mission, best first.
        """
        stones = self.context.use(ObjectDatabase).stones()
        placed = [stone for stone in stones if stone.state is StoneState.PLACED]
        free = [slot for slot in slots if not _is_taken(slot, placed)]
        if not free:
            return failed(f"all {len(slots)} slots are taken")
        return succeeded(FreeSlots(free), f"{len(free)} slots are free")


def _is_taken(slot: Slot, placed: Sequence[Stone]) -> bool:
    """Return whether a stone stands on a slot, not below it: the slot lies under its outline."""
    place = slot.position_map
    return any(
        stone.centroid_map[2] > place[2] and bool(contains(stone.outline_map, place[None, :2])[0])
        for stone in placed
    )
