"""Places whose stone lies in the regions to use, and off those to keep off."""

import numpy as np

from executive.arrays import Float
from executive.messages.slot_layout import SlotLayout


class AllowedPlaces:
    """Holds places against the regions of a layout, for a stone that may be turned in any way."""

    def __init__(self, layout: SlotLayout) -> None:
        self._layout = layout
        radii = [float(np.hypot(one.box_map.length_m, one.box_map.width_m)) / 2
                 for one in (layout.stones if layout.use or layout.keep_off else ())]  # fmt: skip
        self._radius_m = max(radii, default=0.0)

    def at(self, xy: Float) -> bool:
        """Return whether the largest of the stones may stand with its middle at a place (2,)."""
        layout, place = self._layout, xy[None]
        if any(float(one.depth_m(place)[0]) > -self._radius_m for one in layout.keep_off):
            return False
        used = (float(one.depth_m(place)[0]) >= self._radius_m for one in layout.use)
        return not layout.use or any(used)
