"""Wait until the map shows enough to be segmented."""

import numpy as np
from pydantic import Field

from executive.config import Meters, Radians, Seconds, Settings
from executive.events.site import MapDense
from executive.interfaces.mapping import Mapper
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import succeeded
from executive.leaf.surroundings import map_cloud
from executive.messages.sector import Sector


class WaitForDensitySettings(Settings):
    angle: Radians = Field(
        2.094, gt=0, le=6.3, description="Whole angle of the region, about the arm's heading [rad]."
    )
    nearest: Meters = Field(
        3.0, ge=0, description="Inner radius of the region around the machine [m]."
    )
    density: float = Field(
        100.0, gt=0, description="Points of the map on a square metre of the region [1/m²]."
    )
    share: float = Field(
        0.7, gt=0, le=1, description="Share of the region's square metres that are so dense."
    )
    period: Seconds = Field(0.5, gt=0, description="Time between two looks at the map [s].")


class WaitForDensity(Action[WaitForDensitySettings]):
    """Wait while the cabin swings until most of the region is seen densely.

    The region is the part of the ground in front that the arm reaches. Its mean density would be
    carried by the few square metres next to the machine, so each one counts by itself.
    """

    needs = (Mapper,)
    on_resume = OnResume.REDO

    def run(self) -> Steps[None]:
        mapper, sector = self.context.use(Mapper), self._region()
        began_s = self.context.now_s()
        while True:
            share = yield from self.context.job(mapper.dense_share, sector, self.settings.density)
            if share >= self.settings.share:
                waited_s = self.context.now_s() - began_s
                cloud = yield from map_cloud(self.context)
                self.context.record(MapDense(waited_s, share, len(cloud)))
                return succeeded(reason=f"{100 * share:.0f} % of the region after {waited_s:.1f} s")
            asked_s = self.context.now_s()
            while self.context.now_s() < asked_s + self.settings.period:
                yield None

    def _region(self) -> Sector:
        """Return the sector in front of the machine that the arm reaches."""
        base, gripper = self.context.state().T_map_base[:2, 3], self.context.gripper()[:2, 3]
        return Sector(
            centre_map=base,
            heading_rad=float(np.arctan2(*(gripper - base)[::-1])),
            angle_rad=self.settings.angle,
            nearest_m=self.settings.nearest,
            farthest_m=self.context.machine().reach_m,
        )
