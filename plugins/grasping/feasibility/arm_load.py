"""Static efforts of the arm with a stone in the jaws, compared with the limits of the joints."""

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine

_STEP = 1e-4  # step of the central difference [rad] or [m]


class ArmLoad:
    """Static efforts of the joints.

    An effort is the derivative of the potential energy of the arm and its load with respect to the
    position of the joint.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._kinematics = Kinematics(machine)
        self._limits = np.array([joint.max_effort for joint in machine.joints])

    def can_hold(self, q: Float, mass_kg: float) -> bool:
        """Return whether all joints can hold a stone at rest.

        Args:
            q: Positions of the arm joints, shape (n,).
            mass_kg: Mass of the stone; its centre is assumed at the grasp centre of the gripper.
        """
        return bool((np.abs(self.efforts(q, mass_kg)) <= self._limits).all())

    def efforts(self, q: Float, mass_kg: float) -> Float:
        """Return the efforts [N·m] or [N] of the joints at rest on a level base, shape (n,)."""
        steps = _STEP * np.eye(len(q))
        rise = [
            self._energy_j(q + step, mass_kg) - self._energy_j(q - step, mass_kg) for step in steps
        ]
        return np.array(rise) / (2 * _STEP)

    def _energy_j(self, q: Float, mass_kg: float) -> float:
        frames = self._kinematics.frames(q)
        moment = mass_kg * transform(frames["gripper"], self._machine.gripper.grasp_centre)[2]
        for name, link in self._machine.links.items():
            moment += link.mass_kg * transform(frames[name], np.array(link.com_m))[2]
        return float(GRAVITY_M_S2 * moment)
