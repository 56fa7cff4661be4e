"""Find the stones in the map and enter them into the database."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float
from executive.events.site import SiteSegmented
from executive.geometry.voxels import voxel_means
from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.segmentation import Segmenter
from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.messages.cloud import Cloud
from executive.messages.segment import Segmentation
from executive.messages.stone import Stone

_CELL_M = 0.03  # Mascaro 2020, Table 3: res_voxel


@dataclass(frozen=True, slots=True)
class SiteSegments:
    """The site's ground and stones.

    Attributes:
        segmentation: Ground and objects of the merged map.
        stones: The stones as they were seen, in the order of the segments.
    """

    segmentation: Segmentation
    stones: list[Stone]


class Segment(Action):
    """Segment the map, merged with the drone's map where there is one.

    Source: Mascaro et al. 2020, Sec. 4.3 and Sec. 4.4, step 6. Deviation from the paper, which
    merges matched segments pair by pair: segmenting the merged map gives the same models and also
    those stones that only one of the two maps shows.
    """

    needs = (Mapper, Segmenter, ObjectDatabase)

    def run(self, drone_map: Cloud | None = None) -> Steps[SiteSegments]:
        """Segment, and match the segments with known stones.

        Args:
            drone_map: The drone's map expressed in the frame `map`.
        """
        lidar_map = self.context.use(Mapper).cloud()
        parts = [lidar_map.points]
        if drone_map is not None:
            parts.append(self._in_reach(drone_map.points))
        merged = Cloud("map", voxel_means(np.concatenate(parts), _CELL_M))
        if not len(merged):
            return failed("the map is empty: scan first")
        segmentation = yield from self.context.job(self.context.use(Segmenter).segment, merged)
        stones = self.context.use(ObjectDatabase).observe(
            segmentation.segments, self.context.now_s(), drone_map is not None
        )
        ids = tuple(stone.id for stone in stones)
        self.context.record(SiteSegmented(ids, tuple(len(s.points_map) for s in stones)))
        self.context.show("segments", segmentation)
        for stone in stones:
            self.context.show(f"stones/{stone.id}", stone)
        if not stones:
            return failed("no stone was found on the site")
        return succeeded(SiteSegments(segmentation, list(stones)), f"{len(stones)} stones")

    def _in_reach(self, points: Float) -> Float:
        """Return the part of the survey that the arm can reach and the lidar map can confirm."""
        base = self.context.state().T_map_base[:2, 3]
        radius_m = self.context.machine().reach_m + 1.0
        return np.asarray(points[np.hypot(*(points[:, :2] - base).T) < radius_m])
