"""Wait until the map shows enough to be segmented."""

import numpy as np
from pydantic import Field

from executive.arrays import Bool, Float
from executive.config import Meters, Radians, Seconds, Settings
from executive.events.site import MapDense
from executive.interfaces.mapping import Mapper
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import succeeded


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
    """Wait while the cabin swings until most of the region of interest is seen densely (Mascaro
    2020, Sec. 4.3).

    The region is the part of the ground in front that the arm reaches. Its mean density would be
    carried by the few square metres next to the machine, so each one counts by itself.
    """

    needs = (Mapper,)

    def run(self) -> Steps[None]:
        base, gripper = self.context.state().T_map_base[:2, 3], self.context.gripper()[:2, 3]
        heading_rad = float(np.arctan2(*(gripper - base)[::-1]))
        began_s = self.context.now_s()
        while True:
            points = self.context.use(Mapper).cloud().points
            share = self._dense_share(points[:, :2] - base, heading_rad)
            if share >= self.settings.share:
                waited_s = self.context.now_s() - began_s
                self.context.record(MapDense(waited_s, share, len(points)))
                return succeeded(reason=f"{100 * share:.0f} % of the region after {waited_s:.1f} s")
            asked_s = self.context.now_s()
            while self.context.now_s() < asked_s + self.settings.period:
                yield None

    def _dense_share(self, places: Float, heading_rad: float) -> float:
        """Return the share of the region's cells of a square metre that hold enough points, shape
        (N, 2).
        """
        reach = int(np.ceil(self.context.machine().reach_m))
        inside = (np.abs(places) < reach).all(axis=1)
        cells = np.floor(places[inside]).astype(np.int64) + reach
        counts = np.bincount(cells[:, 0] * 2 * reach + cells[:, 1], minlength=(2 * reach) ** 2)
        middles: Float = (
            np.indices((2 * reach, 2 * reach), dtype=np.float64).reshape(2, -1).T + 0.5 - reach
        )
        return float(
            (counts[self._is_in_region(middles, heading_rad)] >= self.settings.density).mean()
        )

    def _is_in_region(self, places: Float, heading_rad: float) -> Bool:
        distances = np.hypot(places[:, 0], places[:, 1])
        aside = np.arctan2(places[:, 1], places[:, 0]) - heading_rad
        turned = np.abs((aside + np.pi) % (2 * np.pi) - np.pi)
        is_near = (distances > self.settings.nearest) & (distances < self.context.machine().reach_m)
        return np.asarray(is_near & (turned < self.settings.angle / 2))
