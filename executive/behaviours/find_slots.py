"""Choose where the stones are to go."""

import numpy as np
from pydantic import Field, model_validator

from executive.config import Meters, Radians, Settings
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.placing import PlacementPlanner
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.region_name import RegionName
from executive.leaf.slots_found import SlotList, tell_slots
from executive.messages.segment import Segmentation
from executive.messages.slot_layout import ANYWHERE, Row, SlotLayout
from executive.messages.stone import Stone, StoneState


class FindSlotsSettings(Settings):
    count: int = Field(7, ge=1, le=50, description="Number of slots wanted.")
    spare: int = Field(
        0,
        ge=0,
        le=50,
        description="Number of further slots for a machine that may tip: a stone that weighs more "
        "than its volume tells may not be carried to its own.",
    )
    at_least: int = Field(1, ge=1, le=50, description="Fewer slots than this are a failure.")
    use: tuple[RegionName, ...] = Field(
        (), description="Regions, in one of which each stone must lie; none: anywhere."
    )
    keep_off: tuple[RegionName, ...] = Field((), description="Regions that no stone may come into.")
    start: tuple[Meters, Meters] | None = Field(
        None, description="Where a straight row begins, x and y in the map [m]."
    )
    heading: Radians | None = Field(
        None, ge=-6.3, le=6.3, description="Direction of the row, from x towards y [rad]."
    )
    gap: Meters = Field(
        0.8, ge=0, le=10, description="Distance between the faces of stones in a row [m]."
    )

    @model_validator(mode="after")
    def _check_row(self) -> "FindSlotsSettings":
        if (self.start is None) != (self.heading is None):
            raise ValueError("a row needs both 'start' and 'heading'")
        return self


class FindSlots(Action[FindSlotsSettings]):
    """Find slots on free ground in reach: on arcs around the machine (Mascaro et al. 2020,
    Sec. 6.1), or, with `start` and `heading`, side by side in a straight row.
    """

    needs = (PlacementPlanner, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self, segmentation: Segmentation, for_stone: int | None = None) -> Steps[SlotList]:
        """Ask the placement planner.

        Args:
            segmentation: Ground and objects of the map.
            for_stone: Id of the stone that the slots are for, by whose size they are spaced; by
                default all that lie on the ground, the largest first.
        """
        planner, T_map_base = self.context.use(PlacementPlanner), self.context.state().T_map_base
        layout, count = self._layout(for_stone), self.settings.count
        if self.context.machine().stance.is_free:
            count += self.settings.spare
        if layout is ANYWHERE:
            slots = yield from self.context.job(planner.slots, segmentation, T_map_base, count)
        else:
            slots = yield from self.context.job(
                planner.slots, segmentation, T_map_base, count, layout
            )
        slots = tell_slots(self.context, slots)
        if len(slots) < self.settings.at_least:
            return failed(
                f"there is free ground for {len(slots)} stones, and {self.settings.at_least} "
                "are wanted"
            )
        return succeeded(SlotList(list(slots)), f"{len(slots)} slots")

    def _layout(self, for_stone: int | None) -> SlotLayout:
        s = self.settings
        if s.start is None and not s.use and not s.keep_off:
            return ANYWHERE
        known = self.context.use(ObjectDatabase).stones()
        row = None
        if s.start is not None and s.heading is not None:
            row = Row(np.array(s.start), s.heading, s.gap)
        wanted = [one for one in known if _is_for(one, for_stone)]
        ids = {one.id for one in wanted}
        return SlotLayout(
            use=tuple(map(self.context.region, s.use)),
            keep_off=tuple(map(self.context.region, s.keep_off)),
            row=row,
            stones=tuple(sorted(wanted, key=lambda one: (-len(one.points_map), one.id))),
            standing=tuple(one for one in known if one.state.is_lying and one.id not in ids),
        )


def _is_for(stone: Stone, for_stone: int | None) -> bool:
    if for_stone is not None:
        return stone.id == for_stone
    return stone.state is StoneState.ON_GROUND
