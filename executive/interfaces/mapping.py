"""Mapping: scans to one cloud of the surroundings."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from executive.arrays import Float
from executive.interfaces.plugin import Plugin
from executive.messages.cloud import Cloud
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion


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
        """Drop returns within this distance [m] of the space between the jaws, from now on; 0 ends
        it.
        """

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
    def cloud(self) -> Cloud:
        """Return the map as it stands, in the frame `map`; deterministic in order."""
