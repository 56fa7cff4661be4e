"""Mapping: scans to one cloud of the surroundings."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from executive.arrays import Float
from executive.interfaces.plugin import Plugin
from executive.messages.cloud import Cloud
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from executive.messages.moving_places import MovingPlaces
from executive.messages.sector import Sector


class Mapper(Plugin, ABC):
    """Build the map around the machine (Mascaro 2020, Sec. 4.2)."""

    capability = "mapping"

    @abstractmethod
    def add_scan_pair(self, scans: Sequence[LidarScan], motion: Motion) -> int:
        """Fuse one scan of each lidar, undistorted by the motion that spans them.

        Returns:
            Number of points kept after the self-filter.
        """

    @abstractmethod
    def mask_held(self, radius_m: float) -> None:
        """Keep returns within this distance [m] of the space between the jaws, and of what may have
        slid there, out of the map, from now on; 0 ends it.
        """

    def held(self) -> Cloud:
        """Return those returns since the last `mask_held`, but for the machine's own, in the frame
        `gripper`: the surface of what is held, as the lidars have seen it.

        It is empty in a mapper that does not keep them.
        """
        return Cloud("gripper", np.empty((0, 3)))

    @abstractmethod
    def remove_sphere(self, centre_map: Float, radius_m: float) -> int:
        """Forget all points in a sphere (Sec. 4.5) and return how many."""

    @abstractmethod
    def add_surface(self, points_map: Float) -> None:
        """Put known surface into the map [m], shape (N, 3), as if it had been seen there.

        A removed sphere may cut into a neighbour whose shape is known (Sec. 4.5); this puts it
        back.
        """

    @abstractmethod
    def dense_share(self, sector: Sector, points_per_m2: float) -> float:
        """Return which share of a sector's square metres the map covers densely, from 0 to 1.

        Each cell of 1 m x 1 m counts by itself: a mean density would be carried by the few cells
        next to the machine.

        Args:
            sector: The part of the ground that is looked at, in the map.
            points_per_m2: Points of the map that make a cell dense [1/m²].

        Raises:
            DataError: If the sector is so small that it holds no cell.
        """

    @abstractmethod
    def cloud(self) -> Cloud:
        """Return the present map, in the frame `map`; deterministic in order."""

    def moving(self) -> MovingPlaces:
        """Return where something moves at present: what is there does not stand on the site.

        It is called in the tick: be fast. There are none in a mapper that does not tell.
        """
        return MovingPlaces(1.0, np.empty((0, 3), dtype=np.int64))
