"""Whether two grasps of a stone are one."""

import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import angle_of_jaws

# Two grasps that are nearer than both count as one: about the spread of the jaws' own errors.
_ALIKE_M, _ALIKE_RAD = 0.1, 0.25


def are_alike(T_object_gripper: Float, T_object_other: Float) -> bool:
    """Return whether two poses of the gripper in a stone's frame, shape (4, 4), are one grasp."""
    T_a, T_b = T_object_gripper, T_object_other
    return (
        bool(np.linalg.norm(T_a[:3, 3] - T_b[:3, 3]) < _ALIKE_M)
        and angle_of_jaws(T_a[:3, :3], T_b[:3, :3]) < _ALIKE_RAD
    )
