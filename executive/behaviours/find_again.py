"""Look for a stone that is no longer where it was."""

from typing import Any

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.leaf.unexplained import unexplained
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.segment import Segmentation
from executive.messages.stone import StoneState


class FindAgainSettings(Settings):
    radius: Meters = Field(
        4.0, gt=0, le=20, description="How far from its last known place to look [m]."
    )


class FindAgain(Action):
    """Look for a dropped or missed stone in the fresh map and update what the database knows of it.

    Its whole model is looked for first, however it lies now and whatever it leans on, so that it
    keeps model and rotation. If that is refused, the map is segmented, and what is seen there may
    replace the model.
    """

    Settings = FindAgainSettings
    needs = ("mapping", "segmentation", "registration", "objects")
    inputs = {"stone": Port(int, "id of the stone")}

    def run(self, **inputs: Any) -> Steps:
        objects = self.context.plugin("objects")
        stone = objects.stone(inputs["stone"])
        points = self.context.plugin("mapping").cloud().points
        near = points[np.hypot(*(points[:, :2] - stone.centroid_map[:2]).T) < self.settings.radius]
        if not len(near):
            return failed(f"the map shows nothing around stone {stone.id}")
        around = unexplained(self.context, stone, self.settings.radius)
        found: Alignment = yield self.context.job(
            "registration", "find", around, Cloud("map", stone.points_map)
        )
        if found.accepted:
            note = f"registration, {found.reason}"
            stone = objects.realign(stone.id, found.T_target_source, self.context.now_s(), note)
            self.context.note(
                "looked_again", stone=stone.id, seen=[stone.id], method="registration", reason=note
            )
            return succeeded(note)
        segmentation: Segmentation = yield self.context.job(
            "segmentation", "segment", Cloud("map", near)
        )
        seen = objects.observe(self._not_placed(segmentation), self.context.now_s(), False)
        numbers = [s.id for s in seen]
        self.context.note(
            "looked_again", stone=stone.id, seen=numbers, method="segmentation", reason=found.reason
        )
        if stone.id not in numbers:
            return failed(
                f"stone {stone.id} was not found within {self.settings.radius:.1f} m of "
                "its last place"
            )
        return succeeded()

    def _not_placed(self, segmentation: Segmentation) -> list[Any]:
        """Leave out segments that are stones which stand in their slots:
        those are not looked for.
        """
        stones = self.context.plugin("objects").stones()
        placed = [
            s.centroid_map[:2]
            for s in stones
            if s.state in (StoneState.PLACED, StoneState.SET_ASIDE)
        ]
        return [
            s
            for s in segmentation.segments
            if all(np.hypot(*(s.centroid[:2] - p)) > 0.6 for p in placed)
        ]
