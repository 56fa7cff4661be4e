"""Lidar odometry as one chain of poses, in the frame in which the odometry started."""

from collections import deque

import numpy as np
from executive_plugins.estimation.gate.measurements import Increment

from executive.arrays import Float

_SAME_S = 5e-4
_KEPT_S = 5.0


class LidarChain:
    """Composes increments; one that does not start where the last ended starts a new chain.

    Attributes:
        way_m: Distance travelled [m], never reset.
        begun: Number of chains so far.
    """

    def __init__(self) -> None:
        self._poses: deque[tuple[float, Float]] = deque()
        self.way_m = 0.0
        self.begun = 0

    def add(self, increment: Increment) -> None:
        """Append an increment; increments come in order of time."""
        if not self._poses or abs(self._poses[-1][0] - increment.from_s) > _SAME_S:
            self._poses.clear()
            self._poses.append((increment.from_s, np.eye(4)))
            self.begun += 1
        self._poses.append((increment.stamp_s, self._poses[-1][1] @ increment.T_from_to))
        self.way_m += float(np.linalg.norm(increment.T_from_to[:3, 3]))
        while self._poses[0][0] < increment.stamp_s - _KEPT_S:
            self._poses.popleft()

    def newest(self) -> tuple[float, Float] | None:
        """Return time [s] and pose (4, 4) of the newest scan; None before the first increment."""
        return self._poses[-1] if self._poses else None

    def before(self, stamp_s: float, within_s: float) -> tuple[float, Float] | None:
        """Return time [s] and pose of the last scan before a time; None if it is too old."""
        for scan_s, T_chain_imu in reversed(self._poses):
            if scan_s <= stamp_s:
                return (scan_s, T_chain_imu) if stamp_s - scan_s <= within_s else None
        return None
