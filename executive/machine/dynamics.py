"""Inverse dynamics of a machine, on Pinocchio: the efforts that a motion of its arm needs."""

import numpy as np
import pinocchio as pin

from executive.arrays import Float
from executive.machine.arm_model import ArmModel
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.machine import Machine


class Dynamics:
    """Efforts of the arm by the recursive Newton-Euler algorithm; not safe between threads.

    Masses, centres of mass and inertias are those of the machine's file. The jaws are closed, and
    the chassis stands still.
    """

    def __init__(self, machine: Machine) -> None:
        self._arm = ArmModel(machine)
        model = self._arm.model
        frame = model.frames[model.getFrameId(machine.gripper_link)]
        self._load_at = frame.placement.act(np.asarray(machine.gripper.grasp_centre))
        self._carrier = frame.parentJoint
        self._empty = model.inertias[self._carrier].copy()

    def efforts(self, q: Float, dq: Float, ddq: Float, up_base: Float, load_kg: float) -> Float:
        """Return the efforts without friction [N·m] or [N], shape (n,).

        Args:
            q: Positions of the arm's joints in the machine's order [rad] or [m], shape (n,).
            dq: Their velocities, shape (n,).
            ddq: Their accelerations, shape (n,).
            up_base: The direction upwards in base axes, a unit vector, shape (3,).
            load_kg: A point mass at the grasp centre [kg].

        Raises:
            ShapeError: If a shape is another.
        """
        arm = self._arm
        arm.model.gravity.linear = -GRAVITY_M_S2 * up_base
        load = pin.Inertia(load_kg, self._load_at, np.zeros((3, 3)))
        arm.model.inertias[self._carrier] = self._empty + load
        velocity, acceleration = np.zeros((2, arm.model.nv))
        velocity[arm.columns], acceleration[arm.columns] = dq, ddq
        at = arm.configuration(q, 0.0)
        needed = pin.rnea(arm.model, arm.data, at, velocity, acceleration)
        return np.asarray(needed[arm.columns])
