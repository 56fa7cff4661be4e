"""Look for a stone that is no longer where it was."""

import numpy as np
from pydantic import Field

from executive.config import Meters, Settings
from executive.events.stone import StoneSoughtAgain
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.registration import Registrar
from executive.interfaces.segmentation import Segmenter
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.surroundings import unexplained
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import StoneState


class FindAgainSettings(Settings):
    radius: Meters = Field(
        4.0, gt=0, le=20, description="Distance from its last known place that is searched [m]."
    )


class FindAgain(Action[FindAgainSettings]):
    """Look for a dropped or missed stone in the new map, and update the database.

    The stone's whole model is registered first, in any orientation and beside whatever it leans
    on, so that model and rotation are kept. If registration refuses, the map is segmented, and the
    segment that is found there may replace the model.
    """

    needs = (Mapper, Segmenter, Registrar, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self, stone: int) -> Steps[None]:
        """Search the surroundings of the stone's last known place.

        Args:
            stone: Id of the stone.
        """
        objects, radius_m = self.context.use(ObjectDatabase), self.settings.radius
        known = objects.stone(stone)
        near = self.context.use(Mapper).cloud().near(known.centroid_map, radius_m)
        if not len(near):
            return failed(f"the map shows nothing around stone {stone}")
        around = unexplained(self.context, stone, radius_m)
        registrar = self.context.use(Registrar)
        found = yield from self.context.job(registrar.find, around, Cloud("map", known.points_map))
        if found.accepted:
            note = f"registration, {found.reason}"
            objects.realign(stone, found.T_target_source, self.context.now_s(), note)
            self.context.record(StoneSoughtAgain(stone, (stone,), "registration", note))
            return succeeded(reason=note)
        segmentation = yield from self.context.job(self.context.use(Segmenter).segment, near)
        seen = objects.observe(self._not_placed(segmentation), self.context.now_s(), False)
        ids = tuple(one.id for one in seen)
        self.context.record(StoneSoughtAgain(stone, ids, "segmentation", found.reason))
        if stone not in ids:
            return failed(f"stone {stone} was not found within {radius_m:.1f} m of its last place")
        return succeeded()

    def _not_placed(self, segmentation: Segmentation) -> list[Segment]:
        """Leave out segments of stones that are in their slots: those are not looked for."""
        stones = self.context.use(ObjectDatabase).stones()
        done = (StoneState.PLACED, StoneState.SET_ASIDE)
        placed = [s.centroid_map[:2] for s in stones if s.state in done]
        return [
            segment
            for segment in segmentation.segments
            if all(np.hypot(*(segment.centroid[:2] - place)) > 0.6 for place in placed)
        ]
