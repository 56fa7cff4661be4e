"""Forward kinematics and Jacobians of a machine, on Pinocchio."""

import numpy as np
import pinocchio as pin

from executive.arrays import Float
from executive.machine.arm_model import ArmModel
from executive.machine.machine import Machine


class Kinematics:
    """Poses of links, sensors and gripper for given joint positions; not safe between threads."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self._arm = ArmModel(machine)
        model = self._arm.model
        self._frames = {name: model.getFrameId(name) for name in (*machine.links, *machine.sensors)}
        self._gripper = self._frames[machine.gripper_link]

    def frames(self, q_arm: Float, jaw_rad: float = 0.0) -> dict[str, Float]:
        """Return T_base_frame of every link and sensor, and of `gripper`, by name.

        Args:
            q_arm: Positions of the arm's joints in the machine's order [rad] or [m], shape (n,).
            jaw_rad: Opening of the jaws [rad].
        """
        pin.framesForwardKinematics(
            self._arm.model, self._arm.data, self._arm.configuration(q_arm, jaw_rad)
        )
        frames = {
            name: np.array(self._arm.data.oMf[i].homogeneous) for name, i in self._frames.items()
        }
        frames["gripper"] = frames[self.machine.gripper_link]
        return frames

    def gripper(self, q_arm: Float) -> Float:
        """Return T_base_gripper, shape (4, 4)."""
        pin.forwardKinematics(self._arm.model, self._arm.data, self._arm.configuration(q_arm, 0.0))
        return np.array(
            pin.updateFramePlacement(self._arm.model, self._arm.data, self._gripper).homogeneous
        )

    def jacobian(self, q_arm: Float) -> Float:
        """Return the Jacobian of the gripper's frame in base axes, shape (6, n).

        Its rows are those of the linear velocity, then those of the angular velocity.
        """
        q = self._arm.configuration(q_arm, 0.0)
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        J = pin.computeFrameJacobian(self._arm.model, self._arm.data, q, self._gripper, axes)
        return np.asarray(J[:, self._arm.columns])
