"""The slots that a leaf has found: numbered, recorded and shown."""

from collections.abc import Sequence
from dataclasses import dataclass

from executive.events.site import SlotPlace, SlotsFound
from executive.leaf.context import Context
from executive.leaf.slot_numbers import numbered
from executive.messages.placement import Slot


@dataclass(frozen=True, slots=True)
class SlotList:
    """Slots of the mission.

    Attributes:
        slots: Slots on free ground in reach, best first.
    """

    slots: list[Slot]


def tell_slots(context: Context, slots: Sequence[Slot]) -> tuple[Slot, ...]:
    """Return the slots with the numbers of their places, after they were recorded and shown."""
    slots = numbered(context, slots)
    places = tuple(SlotPlace(slot.id, slot.position_map) for slot in slots)
    context.record(SlotsFound(places))
    for slot in slots:
        context.show(f"slots/{slot.id}", slot)
    return slots
