"""The machine as a model of Pinocchio."""

import numpy as np
import pinocchio as pin

from executive.arrays import Float
from executive.errors import ShapeError
from executive.machine.machine import Machine
from executive.machine.urdf import urdf


class ArmModel:
    """Model and working memory; not safe between threads.

    Attributes:
        model: The machine's tree of joints.
        data: What Pinocchio computes with.
        columns: Places of the arm's joints in velocities and efforts, in the machine's order.
    """

    def __init__(self, machine: Machine) -> None:
        self.model = pin.buildModelFromXML(urdf(machine))
        self.data = self.model.createData()
        arm = [self.model.joints[self.model.getJointId(name)] for name in machine.arm_names]
        self.columns = np.array([joint.idx_v for joint in arm])
        jaws = (machine.jaw.name, machine.jaw.mirror_name)
        self._jaws = [self.model.joints[self.model.getJointId(name)].idx_q for name in jaws]
        self._neutral = pin.neutral(self.model)
        # Pinocchio holds a continuous joint as (cos, sin).
        self._places = [(joint.idx_q, joint.nq == 2) for joint in arm]

    def configuration(self, q_arm: Float, jaw_rad: float) -> Float:
        """Return the configuration of arm [rad] or [m], shape (n,), and jaws [rad].

        Raises:
            ShapeError: If the shape is another.
        """
        if np.shape(q_arm) != (len(self._places),):
            raise ShapeError(f"q_arm has shape {np.shape(q_arm)}, expected ({len(self._places)},)")
        q = self._neutral.copy()
        for (place, is_continuous), value in zip(self._places, q_arm, strict=True):
            if is_continuous:
                q[place], q[place + 1] = np.cos(value), np.sin(value)
            else:
                q[place] = value
        q[self._jaws] = jaw_rad
        return np.asarray(q)
