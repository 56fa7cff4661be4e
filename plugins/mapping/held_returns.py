"""The returns of what the jaws hold, in the gripper's frame: the map leaves them out."""

import numpy as np

from executive.arrays import Float
from executive.geometry.voxels import voxel_means
from executive.messages.cloud import Cloud

# What hangs in the jaws may have slid by half of its length while they held it, and what the map
# gets of it stays there when it is set down. The look at it, around the grasp centre, stays narrow.
SLIDE = 1.5


class HeldReturns:
    """Collects returns around the grasp centre while something is held, thinned to a grid."""

    def __init__(self, voxel_m: float) -> None:
        self._voxel_m = voxel_m
        self._parts: list[Float] = []

    def clear(self) -> None:
        """Forget everything: the jaws hold nothing, or something else."""
        self._parts.clear()

    def add(self, points_gripper: Float) -> None:
        """Take the held returns of one scan [m], shape (N, 3)."""
        if len(points_gripper):
            self._parts.append(points_gripper)

    def points(self) -> Float:
        """Return all of them in the gripper's frame [m], shape (N, 3)."""
        return np.vstack([np.empty((0, 3)), *self._parts])

    def thinned(self, points_gripper: Float) -> Cloud:
        """Return one point for each occupied voxel, in the frame `gripper`."""
        return Cloud("gripper", voxel_means(points_gripper, self._voxel_m))

    def cloud(self) -> Cloud:
        """Return the returns so far, thinned."""
        return self.thinned(self.points())
