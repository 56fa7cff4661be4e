"""What the arm can hold up where: static efforts of its joints with a stone in the jaws, against
their limits.
"""

import numpy as np
from executive_plugins.physics.gravity import GRAVITY_M_S2

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine

_STEP = 1e-4  # of each joint [rad] or [m], for the slope of the potential energy


class ArmLoad:
    """Static efforts: the slope of the potential energy of all that a joint carries, itself
    included.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._kinematics = Kinematics(machine)
        self._limits = np.array([joint.max_effort for joint in machine.joints])

    def can_hold(self, q: Float, mass_kg: float) -> bool:
        """Return whether no joint needs more than its effort to hold a stone between the jaws at
        rest.

        Args:
            q: Positions of the arm's joints, shape (n,).
            mass_kg: Mass of the stone, its centre where a stone sits in the gripper.
        """
        return bool((np.abs(self.efforts(q, mass_kg)) <= self._limits).all())

    def efforts(self, q: Float, mass_kg: float) -> Float:
        """Return the efforts [N·m] or [N] of the joints at rest, the base level, shape (n,)."""
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
