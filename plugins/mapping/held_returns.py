"""The returns of what the jaws hold, in the gripper's frame: the map leaves them out."""

from collections import deque

import numpy as np

from executive.arrays import Float
from executive.geometry.voxels import voxel_means
from executive.messages.cloud import Cloud

# What hangs in the jaws may have slid by half of its length while they held it, and what the map
# gets of it stays there when it is set down. The look at it, around the grasp centre, stays narrow.
SLIDE = 1.5
MOST = 500_000  # returns, 12 MB: those of minutes


class HeldReturns:
    """Collects returns around the grasp centre while something is held, thinned to a grid.

    A machine may hold its stone for hours; the oldest returns go when there are `most`.
    """

    def __init__(self, voxel_m: float, most: int = MOST) -> None:
        self._voxel_m, self._most = voxel_m, most
        self._parts: deque[Float] = deque()
        self._count = 0

    def clear(self) -> None:
        """Forget everything: the jaws hold nothing, or something else."""
        self._parts.clear()
        self._count = 0

    def add(self, points_gripper: Float) -> None:
        """Take the held returns of one scan [m], shape (N, 3)."""
        if not len(points_gripper):
            return
        self._parts.append(points_gripper)
        self._count += len(points_gripper)
        while len(self._parts) > 1 and self._count - len(self._parts[0]) >= self._most:
            self._count -= len(self._parts.popleft())

    def points(self) -> Float:
        """Return all of them in the gripper's frame [m], shape (N, 3)."""
        return np.vstack([np.empty((0, 3)), *self._parts])

    def thinned(self, points_gripper: Float) -> Cloud:
        """Return one point for each occupied voxel, in the frame `gripper`."""
        return Cloud("gripper", voxel_means(points_gripper, self._voxel_m))

    def cloud(self) -> Cloud:
        """Return the returns so far, thinned."""
        return self.thinned(self.points())
