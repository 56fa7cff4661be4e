"""Forward kinematics and Jacobians of a machine, on Pinocchio."""

import numpy as np
import pinocchio as pin

from executive.arrays import Float
from executive.errors import ShapeError
from executive.machine.machine import Machine
from executive.machine.urdf import urdf


class Kinematics:
    """Poses of links, sensors and gripper for given joint positions; not safe between threads."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self._model = pin.buildModelFromXML(urdf(machine))
        self._data = self._model.createData()
        self._arm = [self._model.joints[self._model.getJointId(name)] for name in machine.arm_names]
        self._columns = np.array([joint.idx_v for joint in self._arm])
        names = (*machine.links, *machine.sensors)
        self._frames = {name: self._model.getFrameId(name) for name in names}
        self._gripper = self._frames[machine.gripper_link]
        jaws = (machine.jaw.name, machine.jaw.mirror_name)
        self._jaws = [self._model.joints[self._model.getJointId(name)].idx_q for name in jaws]
        self._neutral = pin.neutral(self._model)
        # Pinocchio holds a continuous joint as (cos, sin).
        self._places = [(joint.idx_q, joint.nq == 2) for joint in self._arm]

    def frames(self, q_arm: Float, jaw_rad: float = 0.0) -> dict[str, Float]:
        """Return T_base_frame of every link and sensor, and of `gripper`, by name.

        Args:
            q_arm: Positions of the arm's joints in the machine's order [rad] or [m], shape (n,).
            jaw_rad: Opening of the jaws [rad].
        """
        pin.framesForwardKinematics(self._model, self._data, self._configuration(q_arm, jaw_rad))
        frames = {name: np.array(self._data.oMf[i].homogeneous) for name, i in self._frames.items()}
        frames["gripper"] = frames[self.machine.gripper_link]
        return frames

    def gripper(self, q_arm: Float) -> Float:
        """Return T_base_gripper, shape (4, 4)."""
        pin.forwardKinematics(self._model, self._data, self._configuration(q_arm, 0.0))
        return np.array(
            pin.updateFramePlacement(self._model, self._data, self._gripper).homogeneous
        )

    def jacobian(self, q_arm: Float) -> Float:
        """Return the Jacobian of the gripper's frame in base axes, shape (6, n).

        Its rows are those of the linear velocity, then those of the angular velocity.
        """
        q = self._configuration(q_arm, 0.0)
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(self._model, self._data, q, self._gripper, axes)
        return np.asarray(J[:, self._columns])

    def _configuration(self, q_arm: Float, jaw_rad: float) -> Float:
        if np.shape(q_arm) != (len(self._arm),):
            raise ShapeError(f"q_arm has shape {np.shape(q_arm)}, expected ({len(self._arm)},)")
        q = self._neutral.copy()
        for (place, is_continuous), value in zip(self._places, q_arm, strict=True):
            if is_continuous:
                q[place], q[place + 1] = np.cos(value), np.sin(value)
            else:
                q[place] = value
        q[self._jaws] = jaw_rad
        return np.asarray(q)
