"""Find the stones in the map and enter them into the database."""

from typing import Any

import numpy as np

from executive.geometry.voxels import voxel_means
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.messages.cloud import Cloud
from executive.messages.segment import Segmentation
from executive.messages.stone import Stone

_CELL_M = 0.03  # Mascaro 2020, Table 3: res_voxel


class Segment(Action):
    """Segment the map (Mascaro 2020, Sec. 4.3), merged with the drone's where there is one (Sec.
    4.4, step 6).

    The paper merges matched segments pair by pair; segmenting the merged map gives the same models
    and also those stones that only one of the two maps shows.
    """

    needs = ("mapping", "segmentation", "objects")
    inputs = {"drone_map": Port(Cloud, "the drone's map expressed in the map", optional=True)}
    outputs = {
        "segmentation": Port(Segmentation, "ground and objects of the merged map"),
        "stones": Port(list[Stone], "the stones as they were seen, most points first"),
    }

    def run(self, **inputs: Any) -> Steps:
        drone_map: Cloud | None = inputs.get("drone_map")
        lidar_map = self.context.plugin("mapping").cloud()
        parts = (
            [lidar_map.points]
            if drone_map is None
            else [lidar_map.points, self._in_reach(drone_map.points)]
        )
        merged = Cloud("map", voxel_means(np.concatenate(parts), _CELL_M))
        if not len(merged):
            return failed("the map is empty: scan first")
        segmentation: Segmentation = yield self.context.job("segmentation", "segment", merged)
        stones = self.context.plugin("objects").observe(
            segmentation.segments, self.context.now_s(), drone_map is not None
        )
        self.context.note(
            "segmented", stones=[s.id for s in stones], points=[len(s.points_map) for s in stones]
        )
        self.context.show("segments", segmentation)
        for stone in stones:
            self.context.show(f"stones/{stone.id}", stone)
        if not stones:
            return failed("no stone was found on the site")
        return succeeded(f"{len(stones)} stones", segmentation=segmentation, stones=list(stones))

    def _in_reach(self, points: np.ndarray) -> np.ndarray:
        """Keep the part of the survey that the lidar map can confirm: the rest is nobody's business
        here.
        """
        base = self.context.state().T_map_base[:2, 3]
        radius_m = self.context.machine().reach_m + 1.0
        return np.asarray(points[np.hypot(*(points[:, :2] - base).T) < radius_m])
