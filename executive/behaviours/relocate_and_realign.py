"""Bring a moved stone's model and the map together again."""

from collections.abc import Generator
from typing import Any

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.leaf.action import Action, Steps
from executive.leaf.job import Job
from executive.leaf.outcome import succeeded
from executive.leaf.port import Port
from executive.leaf.unexplained import unexplained
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone


class RelocateAndRealignSettings(Settings):
    margin: Meters = Field(
        0.5, gt=0, le=2, description="Map around the model that the alignment sees [m]."
    )
    max_distance: Meters = Field(0.3, gt=0, le=2, description="Farthest correspondence [m].")
    max_shift: Meters = Field(
        0.5, gt=0, le=2, description="A larger correction by alignment is not believed [m]."
    )
    search_radius: Meters = Field(
        2.0, gt=0, le=10, description="How far around a lost stone is looked for [m]."
    )


class RelocateAndRealign(Action):
    """Correct a relocated stone's pose by aligning its model with the fresh map (Mascaro 2020, Sec.
    4.5).

    It needs a scan of the stone's new place. A stone that settled beyond the aligner's basin is
    looked for anew by registration, however it lies. What that refuses, too, is noted and not made:
    the pose from the gripper's motion (Eq. 3) stands.
    """

    Settings = RelocateAndRealignSettings
    needs = ("mapping", "alignment", "registration", "objects")
    inputs = {"stone": Port(int, "id of the stone")}

    def run(self, **inputs: Any) -> Steps:
        objects = self.context.plugin("objects")
        stone: Stone = objects.stone(inputs["stone"])
        method, alignment, refusal = yield from self._correct(stone)
        if not refusal:
            note = f"{method}, {alignment.reason}"
            stone = objects.realign(stone.id, alignment.T_target_source, self.context.now_s(), note)
        self.context.note(
            "realigned",
            stone=stone.id,
            accepted=not refusal,
            method=method,
            reason=refusal,
            rmse_m=alignment.rmse_m,
            overlap=alignment.overlap,
            estimated_pose=stone.T_map_object,
        )
        self.context.show(f"stones/{stone.id}", stone)
        return succeeded(
            f"kept the gripper's estimate: {refusal}" if refusal else f"realigned by {method}"
        )

    def _correct(self, stone: Stone) -> Generator[Job, Any, tuple[str, Alignment, str]]:
        """Return by which method, the motion in the map, and why it is not to be believed, if it is
        not.
        """
        source = Cloud("map", stone.points_map)
        target = self._map_around(stone)
        aligned: Alignment = yield self.context.job(
            "alignment", "align", target, source, np.eye(4), self.settings.max_distance
        )
        refusal = self._refusal(aligned, stone)
        if not refusal:
            return "alignment", aligned, ""
        around = unexplained(self.context, stone, self.settings.search_radius)
        found: Alignment = yield self.context.job("registration", "find", around, source)
        if found.accepted:
            return "registration", found, ""
        return "alignment", aligned, f"{refusal}; looked for anew: {found.reason}"

    def _map_around(self, stone: Stone) -> Cloud:
        points = self.context.plugin("mapping").cloud().points
        low = stone.points_map.min(axis=0) - self.settings.margin
        high = stone.points_map.max(axis=0) + self.settings.margin
        return Cloud("map", points[((points >= low) & (points <= high)).all(axis=1)])

    def _refusal(self, alignment: Alignment, stone: Stone) -> str:
        if not alignment.accepted:
            return alignment.reason
        centroid = stone.centroid_map
        shift_m = float(np.linalg.norm(alignment.apply(centroid[None])[0] - centroid))
        if shift_m > self.settings.max_shift:
            return f"a correction of {shift_m:.2f} m is more than {self.settings.max_shift:.2f} m"
        return ""
