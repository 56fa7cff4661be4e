"""Places of stones side by side along a straight row, apart by the distance of their faces."""

from collections.abc import Callable, Sequence

import numpy as np

from executive.arrays import Float
from executive.geometry.polygon import outline_gap, rectangle
from executive.messages.placement import Slot
from executive.messages.slot_layout import Row, SlotLayout

_STEP_M = 0.01  # along the row; below the noise of a map


def row_of_stones(
    layout: SlotLayout,
    row: Row,
    count: int,
    length_m: float,
    height_of: Callable[[Float], float | None],
) -> list[Slot]:
    """Return places along a row, from its start on, each as near to the one before as may be.

    A stone stands with the longer side of its box along the row. It keeps the gap of the row from
    the outline of each standing stone and from the box of each place before, so that a row with
    stones in it is continued, and a gap in it that is wide enough is filled.

    Args:
        layout: The stones, those that stand already, and the regions. Where more places are wanted
            than there are stones, the last stone is taken for the rest.
        row: Start, direction and gap.
        count: Number of places wanted.
        length_m: Length of the row that is looked at [m].
        height_of: Returns the ground height [m] at a place (2,), None where none is possible.
    """
    along = np.array([np.cos(row.heading_rad), np.sin(row.heading_rad)])
    taken = [stone.outline_map for stone in layout.standing]
    boxes = [stone.box_map for stone in layout.stones]
    slots: list[Slot] = []
    begin_m = 0.0
    while len(slots) < count and boxes and begin_m < length_m:
        box = boxes[min(len(slots), len(boxes) - 1)]
        centre = row.start_map + (begin_m + box.length_m / 2) * along
        corners = rectangle(centre, box.length_m, box.width_m, row.heading_rad)
        height_m = None
        if is_allowed(corners, layout) and _is_apart(corners, taken, row.gap_m):
            height_m = height_of(centre)
        if height_m is None:
            begin_m += _STEP_M
            continue
        slots.append(
            Slot(len(slots) + 1, np.array([*centre, height_m]), row.heading_rad, row.gap_m)
        )
        taken.append(corners)
        begin_m += box.length_m + row.gap_m
    return slots


def is_allowed(corners: Float, layout: SlotLayout) -> bool:
    """Return whether an outline (V, 2) lies in a region to use, and off those to keep off."""
    if any(region.touches(corners) for region in layout.keep_off):
        return False
    return not layout.use or any((one.depth_m(corners) >= 0).all() for one in layout.use)


def _is_apart(corners: Float, taken: Sequence[Float], gap_m: float) -> bool:
    return all(outline_gap(corners, outline) >= gap_m - 1e-9 for outline in taken)
