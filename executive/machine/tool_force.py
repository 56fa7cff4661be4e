"""The force that the surroundings exert on the tool, by the efforts of the arm's joints."""

import numpy as np

from executive.arrays import Float
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine


class ToolForce:
    """Fits a force at the grasp centre to efforts of the arm; not safe between threads.

    Args:
        machine: The machine.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine, self._kinematics = machine, Kinematics(machine)

    def explaining(self, q: Float, effort: Float) -> Float:
        """Return the force on the tool that explains efforts of an arm at rest [N], shape (3,).

        Its axes are those of the base. The least-squares fit does not scale the efforts, so that
        joints with the longest levers have the largest weight: they depend least on where between
        the tips the force acts.

        Args:
            q: Positions of the arm's joints [rad] or [m], shape (n,).
            effort: Efforts of them beyond those that hold the arm without that force [N·m] or [N],
                shape (n,).
        """
        J = self._kinematics.jacobian(q)
        arm = self._kinematics.gripper(q)[:3, :3] @ self._machine.gripper.grasp_centre
        J_centre = J[:3] + np.cross(J[3:], arm, axisa=0, axisc=0)  # v + ω × arm
        return np.asarray(-np.linalg.lstsq(J_centre.T, effort, rcond=None)[0])
