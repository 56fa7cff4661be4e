"""One scan of each lidar, combined into one cloud in the cabin's frame (Mascaro 2020, 4.2)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.mapping.cylinder import Cylinder
from executive_plugins.mapping.scan_front_end import ScanFrontEnd
from numpy.typing import NDArray

from executive.arrays import Float
from executive.geometry.pose import inverse, transform
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion

SinglePrecision = NDArray[np.float32]  # 1 µm at 10 m, half the memory


@dataclass(frozen=True, slots=True, eq=False)
class ScanPair:
    """A combined pair, without returns of the machine and corrected for its motion.

    The paper's pairs are in the frame of the horizontal lidar. These are in the frame of the cabin,
    because the state estimate gives its covariance.

    Attributes:
        stamp_s: End of the newer scan [s].
        points_cabin: Returns in the mapped cylinder, in the cabin's frame at that time [m],
            shape (N, 3).
        T_map_cabin: The state estimate's pose at that time, shape (4, 4).
        kept: Number of returns that are not of the machine, at any distance.
    """

    stamp_s: float
    points_cabin: SinglePrecision
    T_map_cabin: Float
    kept: int


def assemble(
    front_end: ScanFrontEnd,
    scans: Sequence[LidarScan],
    motion: Motion,
    held_radius_m: float,
    cylinder: Cylinder,
) -> ScanPair | None:
    """Return the pair; None if no return is left.

    Raises:
        DataError: If a scan's sensor is no lidar of the machine, or the motion lacks a joint.
    """
    parts = [front_end.place(scan, motion, held_radius_m) for scan in scans]
    points_map = np.vstack([np.empty((0, 3)), *parts])
    if not len(points_map):
        return None
    stamp_s = max(scan.stamp_s for scan in scans)
    T_map_cabin = motion.T_map_cabin_at(stamp_s)
    near = transform(inverse(T_map_cabin), points_map[cylinder.contains(points_map)])
    return ScanPair(stamp_s, near.astype(np.float32), T_map_cabin, len(points_map))
