"""Places of stones side by side along a straight row, apart by the distance of their faces."""

from collections.abc import Callable, Sequence

import numpy as np

from executive.arrays import Float
from executive.geometry.polygon import outline_gap, rectangle
from executive.messages.placement import Slot
from executive.messages.slot_layout import Row, SlotLayout

_STEP_M = 0.01  # along the row past a stone; below the noise of a map
_FAR_STEP_M = 0.1  # past ground that carries no stone or is out of reach: asking there takes long


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
        lacking_m = _lacking_m(corners, taken, row.gap_m)
        if lacking_m > 0 or not is_allowed(corners, layout):
            begin_m += max(_STEP_M, lacking_m)
            continue
        height_m = height_of(centre)
        if height_m is None:
            begin_m += _FAR_STEP_M
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


def _lacking_m(corners: Float, taken: Sequence[Float], gap_m: float) -> float:
    """Return by how much the gap to the nearest taken outline is too small [m]; 0 if it is not.

    A shorter way along the row cannot make it large enough.
    """
    nearest_m = min((outline_gap(corners, outline) for outline in taken), default=gap_m)
    lacking_m = gap_m - nearest_m
    return lacking_m if lacking_m > 1e-9 else 0.0
