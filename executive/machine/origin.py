"""The pose of a part in its parent's frame: position and fixed-axis angles, as in URDF."""

from functools import cached_property

import numpy as np
from pydantic import Field

from executive.arrays import Float, checked
from executive.config import Settings
from executive.geometry.pose import pose_xyz_rpy

Vec3 = tuple[float, float, float]


class Origin(Settings):
    """A pose in a parent frame."""

    xyz_m: Vec3 = Field((0.0, 0.0, 0.0), description="Position [m].")
    rpy_rad: Vec3 = Field((0.0, 0.0, 0.0), description="Roll, pitch, yaw about fixed axes [rad].")

    @cached_property
    def T(self) -> Float:
        """The pose T_parent_child, shape (4, 4)."""
        return checked("origin", pose_xyz_rpy(np.array(self.xyz_m), np.array(self.rpy_rad)), 4, 4)
