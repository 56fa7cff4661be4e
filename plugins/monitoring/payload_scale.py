"""The mass in the gripper, estimated from the efforts of the arm joints with Pinocchio."""

import numpy as np
import pinocchio as pin

from executive.arrays import Bool, Float
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.machine.sensor import Encoders
from executive.machine.urdf import urdf
from executive.messages.joints import JointSample

_OFF_CENTRE_M = 0.15  # a stone's centre from the grasp centre: a tenth of the widest opening


def encoders_of(machine: Machine) -> Encoders:
    """Return the sensor of joints and efforts."""
    return next(one for one in machine.sensors.values() if isinstance(one, Encoders))


class PayloadScale:
    """Compares measured efforts with those that hold the empty machine.

    The result is valid while the arm does not accelerate.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._kinematics = Kinematics(machine)
        self._model = pin.buildModelFromXML(urdf(machine))
        self._model.gravity.linear = np.array([0.0, 0.0, -GRAVITY_M_S2])
        self._data = self._model.createData()
        self._joints = [
            self._model.joints[self._model.getJointId(name)] for name in machine.joint_names
        ]
        noise = encoders_of(machine).effort_noise
        self._effort_std = noise * np.array([joint.max_effort for joint in machine.joints])
        # Of cylinders and seals, against the motion; without hydraulics the efforts are those told.
        share = 0.0 if machine.hydraulics is None else machine.hydraulics.friction
        self._friction = share * np.array([joint.max_effort for joint in machine.joints])
        self._mirror = self._model.joints[self._model.getJointId(machine.jaw.mirror_name)]

    def weigh(self, sample: JointSample) -> float:
        """Return the mass in the gripper [kg] that explains the efforts best.

        Noise may make it negative. The least-squares fit does not scale the efforts, so the joints
        with the longest levers have the largest weight; they depend least on where the stone is
        between the jaws.
        """
        q, effort = self._arranged(sample)
        lever = self.lever(q[:-1])
        missing = effort[:-1] - self.empty_effort(q)
        return float(lever @ missing / max(float(lever @ lever), 1e-9))

    def gripper(self, q_arm: Float) -> Float:
        """Return T_base_gripper, shape (4, 4)."""
        return self._kinematics.gripper(q_arm)

    def lever(self, q_arm: Float) -> Float:
        """Return the effort per kilogram at the grasp centre, [N·m/kg] or [N/kg], shape (n,)."""
        J = self._kinematics.jacobian(q_arm)
        arm = self._kinematics.gripper(q_arm)[:3, :3] @ self._machine.gripper.grasp_centre
        vertical = J[2] + J[3] * arm[1] - J[4] * arm[0]  # z row of v + ω × arm
        return np.asarray(GRAVITY_M_S2 * vertical)

    def empty_effort(self, q: Float) -> Float:
        """Return the efforts of the arm joints that hold the empty machine still, shape (n,).

        Args:
            q: Positions of the arm joints, then of the jaw, shape (n + 1,).
        """
        gravity = pin.computeGeneralizedGravity(self._model, self._data, self._configuration(q))
        return np.array([gravity[joint.idx_v] for joint in self._joints[:-1]])

    def noise_kg(self, q_arm: Float) -> float:
        """Return the standard deviation of the mass by the noise of one sample's efforts [kg]."""
        lever = self.lever(q_arm)
        return float(np.linalg.norm(lever * self._effort_std) / max(float(lever @ lever), 1e-9))

    def lever_share(self, q_arm: Float) -> float:
        """Return the standard deviation of the mass as a share of it, because the stone's centre
        may be some decimetres off the grasp centre.
        """
        out_m = np.linalg.norm(self._kinematics.gripper(q_arm)[:2, 3])
        return float(_OFF_CENTRE_M / max(float(out_m), _OFF_CENTRE_M))

    def moving_kg(self, q: Float, acceleration: Float, is_moving: Bool) -> float:
        """Return the standard deviation of the mass by the efforts that move the empty arm [kg].

        They are those of its inertia, and of the friction of the joints that move. An arm of some
        tonnes that begins to rise needs as much as a small stone weighs.

        Args:
            q: Positions of the arm joints, then of the jaw, shape (n + 1,).
            acceleration: Of the arm joints, shape (n,).
            is_moving: Which of them move, shape (n,).
        """
        lever, rows = self.lever(q[:-1]), [joint.idx_v for joint in self._joints[:-1]]
        full = pin.crba(self._model, self._data, self._configuration(q))
        inertia = (np.triu(full) + np.triu(full, 1).T)[np.ix_(rows, rows)]
        shaken = float(np.abs(lever) @ np.abs(inertia @ acceleration))
        rubbed = float(np.linalg.norm(lever * self._friction * is_moving))
        return float(np.hypot(shaken, rubbed) / max(float(lever @ lever), 1e-9))

    def shaken_share(self, q_arm: Float, acceleration: Float) -> float:
        """Return by what share joint accelerations may change the weight at the grasp centre."""
        vertical = np.abs(self.lever(q_arm)) / GRAVITY_M_S2
        return float(vertical @ np.abs(acceleration) / GRAVITY_M_S2)

    def rise_noise_m_s(self, q_arm: Float, velocity_noise: float) -> float:
        """Return the standard deviation of `rise_m_s` [m/s]."""
        return float(np.linalg.norm(self.lever(q_arm)) / GRAVITY_M_S2 * velocity_noise)

    def rise_m_s(self, sample: JointSample) -> float:
        """Return the vertical speed of the grasp centre [m/s]."""
        q, _ = self._arranged(sample)
        velocity = np.array([sample.of(name)[1] for name in self._machine.arm_names])
        return float(self.lever(q[:-1]) @ velocity / GRAVITY_M_S2)

    def _arranged(self, sample: JointSample) -> tuple[Float, Float]:
        states = np.array([sample.of(name) for name in self._machine.joint_names])
        return states[:, 0], states[:, 2]

    def _configuration(self, q: Float) -> Float:
        full = pin.neutral(self._model)
        for joint, value in zip([*self._joints, self._mirror], [*q, q[-1]], strict=True):
            if joint.nq == 2:  # Pinocchio represents a continuous joint by (cos, sin)
                full[joint.idx_q], full[joint.idx_q + 1] = np.cos(value), np.sin(value)
            else:
                full[joint.idx_q] = value
        return np.asarray(full)
