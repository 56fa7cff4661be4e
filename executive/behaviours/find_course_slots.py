"""Find the places of the next course of a row of stones."""

import itertools

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Radians, Settings
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.slots_found import SlotList, tell_slots
from executive.messages.placement import Slot
from executive.messages.stone import Stone

_TOP = 0.95  # quantile of heights that counts as the top: the next stone rests on the highest parts


class FindCourseSlotsSettings(Settings):
    heading: Radians = Field(
        ge=-6.3,
        le=6.3,
        examples=["180 deg"],
        description="Direction of the row, from x towards y [rad].",
    )
    gap: Meters = Field(0.1, ge=0, le=10, description="Distance between the faces of stones [m].")
    near: Meters = Field(
        0.5, gt=0, le=5, description="Part of each stone beside a gap that carries the next [m]."
    )


class FindCourseSlots(Condition[FindCourseSlotsSettings]):
    """Find a slot over the gap between each two neighbours of a course; fail without a gap.

    Each stone of the next course then rests on two of this one, as a wall is built.
    """

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def check(self, course: list[int]) -> Outcome[SlotList]:
        """Find the slots from where the stones are now.

        Args:
            course: Ids of the stones of the course, in any order.
        """
        stones = [self.context.use(ObjectDatabase).stone(one) for one in course]
        heading_rad = self.settings.heading
        axes = np.array(
            [
                [np.cos(heading_rad), np.sin(heading_rad)],
                [-np.sin(heading_rad), np.cos(heading_rad)],
            ]
        )
        along = sorted(stones, key=lambda one: float(axes[0] @ one.box_map.centre))
        places = [self._over(one, two, axes) for one, two in itertools.pairwise(along)]
        if not places:
            return failed(f"a course of {len(course)} stones has no gap for a stone to rest on")
        gap_m = self.settings.gap
        slots = [Slot(i, place, heading_rad, gap_m) for i, place in enumerate(places, start=1)]
        told = tell_slots(self.context, slots)
        return succeeded(SlotList(list(told)), f"{len(told)} slots")

    def _over(self, one: Stone, two: Stone, axes: Float) -> Float:
        """Return the place over the gap of two neighbours in the map [m], shape (3,)."""
        faces = (one.outline_map @ axes[0]).max(), (two.outline_map @ axes[0]).min()
        middle = float(np.mean(faces))
        across = float(np.mean([axes[1] @ stone.box_map.centre for stone in (one, two)]))
        tops = []
        for stone in (one, two):
            away = np.abs(stone.points_map[:, :2] @ axes[0] - middle)
            near = away < max(self.settings.near, float(away.min()) + self.settings.near)
            tops.append(float(np.quantile(stone.points_map[near, 2], _TOP)))
        return np.array([*(middle * axes[0] + across * axes[1]), max(tops)])
