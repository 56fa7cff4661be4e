"""Joint encoders, and joint efforts from cylinder pressures."""

import mujoco
import numpy as np

from executive.machine.machine import Machine
from executive.machine.sensor import Encoders
from executive.messages.joints import JointSample


class JointEncoders:
    """All encoders and pressure sensors of the machine, sampled together."""

    def __init__(
        self, encoders: Encoders, machine: Machine, model: mujoco.MjModel, rng: np.random.Generator
    ) -> None:
        self.encoders = encoders
        self._names = machine.joint_names
        self._rng = rng
        joints = [model.joint(name) for name in self._names]
        self._qpos = np.array([joint.qposadr[0] for joint in joints])
        self._dof = np.array([joint.dofadr[0] for joint in joints])
        # The last joint is the jaw, which turns.
        is_length = [*(joint.kind == "prismatic" for joint in machine.joints), False]
        self._position_std = np.where(is_length, encoders.length_noise_m, encoders.angle_noise_rad)
        limits = [joint.max_effort for joint in machine.joints] + [machine.jaw.max_effort]
        self._effort_std = encoders.effort_noise * np.array(limits)

    def sample(self, time_s: float, data: mujoco.MjData) -> JointSample:
        """Measure; an effort is that of the joint's drive, the weights of the links included."""
        position, velocity, effort = self._rng.standard_normal((3, len(self._names)))
        return JointSample(
            time_s,
            self._names,
            data.qpos[self._qpos] + self._position_std * position,
            data.qvel[self._dof] + self.encoders.velocity_noise * velocity,
            data.qfrc_actuator[self._dof] + self._effort_std * effort,
        )
