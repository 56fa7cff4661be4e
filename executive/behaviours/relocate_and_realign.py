"""Correct a moved stone's pose on the new map."""

from collections.abc import Generator
from typing import Any

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.events.stone import StoneRealigned
from executive.interfaces.alignment import Aligner
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.registration import Registrar
from executive.leaf.action import Action, Steps
from executive.leaf.job import Job
from executive.leaf.memory import OnResume
from executive.leaf.outcome import succeeded
from executive.leaf.surroundings import unexplained
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone


class RelocateAndRealignSettings(Settings):
    margin: Meters = Field(
        0.5, gt=0, le=2, description="Margin of the map around the model for the alignment [m]."
    )
    max_distance: Meters = Field(0.3, gt=0, le=2, description="Farthest correspondence [m].")
    max_shift: Meters = Field(
        0.5, gt=0, le=2, description="A larger correction by alignment is refused [m]."
    )
    search_radius: Meters = Field(
        2.0, gt=0, le=10, description="Radius of the search for a stone that was lost [m]."
    )


class RelocateAndRealign(Action[RelocateAndRealignSettings]):
    """Correct a relocated stone's pose by aligning its model with the new map.

    It needs a scan of the stone's new place. A stone that settled beyond the aligner's basin is
    looked for by registration, in any orientation. What registration refuses, too, is recorded and
    not corrected: the pose from the gripper's motion (Eq. 3) is kept.

    Source: Mascaro et al. 2020, Sec. 4.5.
    """

    needs = (Mapper, Aligner, Registrar, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self, stone: int) -> Steps[None]:
        """Align, or register, and store the corrected pose.

        Args:
            stone: Id of the stone.
        """
        objects = self.context.use(ObjectDatabase)
        known = objects.stone(stone)
        method, alignment, refusal = yield from self._correct(known)
        if not refusal:
            note = f"{method}, {alignment.reason}"
            known = objects.realign(stone, alignment.T_target_source, self.context.now_s(), note)
        self.context.record(
            StoneRealigned(
                stone=stone,
                accepted=not refusal,
                method=method,
                reason=refusal,
                rmse_m=alignment.rmse_m,
                overlap=alignment.overlap,
                estimated_pose=known.T_map_object,
            )
        )
        self.context.show(f"stones/{stone}", known)
        return succeeded(
            reason=f"kept the pose from the gripper's motion: {refusal}"
            if refusal
            else f"realigned by {method}"
        )

    def _correct(self, stone: Stone) -> Generator[Job[Alignment], Any, tuple[str, Alignment, str]]:
        """Return the method, the motion in the map, and why it is refused; empty if it is not."""
        source = Cloud("map", stone.points_map)
        aligned = yield from self.context.job(
            self.context.use(Aligner).align,
            self._map_around(stone),
            source,
            np.eye(4),
            self.settings.max_distance,
        )
        refusal = self._refusal(aligned, stone)
        if not refusal:
            return "alignment", aligned, ""
        around = unexplained(self.context, stone.id, self.settings.search_radius)
        found = yield from self.context.job(self.context.use(Registrar).find, around, source)
        if found.accepted:
            return "registration", found, ""
        return "alignment", aligned, f"{refusal}; registration: {found.reason}"

    def _map_around(self, stone: Stone) -> Cloud:
        low = stone.points_map.min(axis=0) - self.settings.margin
        high = stone.points_map.max(axis=0) + self.settings.margin
        return self.context.use(Mapper).cloud().in_box(low, high)

    def _refusal(self, alignment: Alignment, stone: Stone) -> str:
        if not alignment.accepted:
            return alignment.reason
        centroid = stone.centroid_map
        shift_m = float(np.linalg.norm(alignment.apply(centroid[None])[0] - centroid))
        if shift_m > self.settings.max_shift:
            return f"a correction of {shift_m:.2f} m is more than {self.settings.max_shift:.2f} m"
        return ""
