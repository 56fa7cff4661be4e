"""How low a stone may hang that has turned in the jaws: for plans of setting it down."""

import numpy as np

from executive.arrays import Float
from executive.machine.machine import Machine


def lower_by_m(machine: Machine, jaw_rad: float, surface: Float, T_map_gripper: Float) -> float:
    """Return by how much lower than its model a stone hangs at most, however it has turned [m].

    It turns about the middle of the tips, so that what is farthest from there may come to be below.

    Args:
        machine: The machine whose jaws hold it.
        jaw_rad: Angle of the jaws [rad].
        surface: Surface of the stone in the gripper's frame [m], shape (N, 3).
        T_map_gripper: Pose of the gripper, shape (4, 4).
    """
    middle = machine.gripper.tips(jaw_rad).mean(axis=0)
    expected_m = float(((middle - surface) @ T_map_gripper[2, :3]).max())
    turned_m = float(np.linalg.norm(surface - middle, axis=1).max())
    return max(0.0, turned_m - expected_m)
