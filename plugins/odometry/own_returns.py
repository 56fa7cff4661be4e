"""A lidar's returns from the machine itself.

They move with the sensor, so that a match that used them would find too little motion.
"""

import numpy as np

from executive.arrays import Bool
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.machine.rig import Rig
from executive.machine.self_filter import SelfFilter
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan

_PADDING_M = 0.2  # the arm moves by a third of this during a revolution
_HELD_M = 1.2  # radius around the grasp centre, for a stone that may be held


class OwnReturns:
    """Finds returns of the machine by the shapes of its links; a rig without links has none."""

    def __init__(self, machine: Rig) -> None:
        self._machine = machine if isinstance(machine, Machine) else None
        self._joints: JointSample | None = None
        if self._machine is not None:
            self._kinematics = Kinematics(self._machine)
            self._filter = SelfFilter(self._machine, _PADDING_M)
            self._filter.compile()

    def add_joints(self, sample: JointSample) -> None:
        """Take the newest joint sample."""
        self._joints = sample

    def among(self, scan: LidarScan) -> Bool:
        """Return which returns are of the machine or of a held stone, shape (N,)."""
        if self._machine is None or self._joints is None or not len(scan.points_lidar):
            return np.zeros(len(scan.points_lidar), dtype=bool)
        arm = np.array([self._joints.of(name)[0] for name in self._machine.arm_names])
        frames = self._kinematics.frames(arm, self._joints.of(self._machine.jaw.name)[0])
        slices = np.zeros(len(scan.points_lidar), dtype=np.int64)
        return self._filter.inside(scan.points_lidar, slices, scan.frame, [frames], _HELD_M)
