"""Numbers of slots: a place keeps its number for the whole mission."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from executive.events.site import SlotsFound
from executive.leaf.context import Context
from executive.messages.placement import Slot

# Places nearer than this are one slot: more than the estimate of the chassis strays between two
# calls (an RTK fix is good to 2 cm), less than two stones could stand apart.
_SAME_M = 0.1


def numbered(context: Context, slots: Sequence[Slot]) -> tuple[Slot, ...]:
    """Return slots with the numbers that their places had before; new places get new numbers."""
    known = [place for event in context.recorded(SlotsFound) for place in event.slots]
    next_number = max((place.slot for place in known), default=0) + 1
    found: list[Slot] = []
    for slot in slots:
        used = {one.id for one in found}
        same = [
            place.slot
            for place in known
            if np.linalg.norm(place.position_map - slot.position_map) < _SAME_M
            and place.slot not in used
        ]
        number = same[0] if same else next_number
        next_number += not same
        found.append(slot if slot.id == number else replace(slot, id=number))
    return tuple(found)
