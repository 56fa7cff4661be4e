"""Numbers of slots: a place keeps its number for the whole mission."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from executive.leaf.context import Context
from executive.messages.placement import Slot

# Places nearer than this are one slot: more than the estimate of the chassis strays between two
# calls (an RTK fix is good to 2 cm), less than two stones could stand apart.
_SAME_M = 0.1


def numbered(context: Context, slots: Sequence[Slot]) -> tuple[Slot, ...]:
    """Return slots with the numbers that their places had before; new places get new numbers."""
    known = context.slot_places()
    next_number = max(known, default=0) + 1
    found: dict[int, Slot] = {}
    for slot in slots:
        same = (
            number
            for number, place in known.items()
            if number not in found and np.linalg.norm(place - slot.position_map) < _SAME_M
        )
        number = next(same, next_number)
        next_number = max(next_number, number + 1)
        found[number] = slot if slot.id == number else replace(slot, id=number)
    return tuple(found.values())
