"""Made-up holds: what arm and jaws measure while a machine lifts, carries, sets down, loses."""

import numpy as np
from executive_plugins.monitoring.payload_scale import PayloadScale

from executive.arrays import Float
from executive.machine.machine import Machine
from executive.messages.joints import JointSample
from executive.messages.verdict import Verdict

RATE_HZ = 50
HELD_RAD, FORCE = 0.5, 88e3  # the jaws' angle [rad] and the effort with which they press [N·m]
MASS_KG = 1800.0
FAULT_S = 8.0


class Carry:
    """A hold of some seconds, as signals that a test may change: share of the weight, jaws' angle
    [rad], their force [N·m], speed of the boom [rad/s]. The arm lifts after one second.
    """

    def __init__(self, duration_s: float = 12.0) -> None:
        self.t = np.arange(round(duration_s * RATE_HZ)) / RATE_HZ
        self.weight = np.clip(2 * (self.t - 1.0), 0.0, 1.0)
        self.jaw = np.full(len(self.t), HELD_RAD)
        self.force = np.full(len(self.t), FORCE)
        self.boom = np.where((self.t > 1.0) & (self.t < 2.5), 0.1, 0.0)
        self.mass_kg = MASS_KG

    def after(self, time_s: float, ramp_s: float = 0.02) -> Float:
        """Return a step from 0 to 1."""
        return np.asarray(np.clip((self.t - time_s) / ramp_s, 0.0, 1.0))

    def samples(self, machine: Machine, scale: PayloadScale, seed: int = 0) -> list[JointSample]:
        rng = np.random.default_rng(seed)
        noise = next(one.effort_noise for one in machine.sensors_of("encoders"))
        limits = np.array([joint.max_effort for joint in machine.joints] + [machine.jaw.max_effort])
        q = machine.posture("carry")
        q[1] = 0.6
        series = []
        for i, stamp_s in enumerate(self.t):
            q[1] += self.boom[i] / RATE_HZ
            position = np.append(q, self.jaw[i] + rng.normal(0, 2e-4))
            lever = scale.lever(q)
            effort = scale.empty_effort(position) + self.mass_kg * self.weight[i] * lever
            effort = np.append(effort, -self.force[i]) + rng.normal(0.0, noise * limits)
            velocity = rng.normal(0.0, 2e-3, len(position))
            velocity[1] += self.boom[i]
            series.append(JointSample(stamp_s, machine.joint_names, position, velocity, effort))
        return series


def lowered() -> Carry:
    """Return a carry whose boom sinks between the 6th and the 8th second."""
    carry = Carry()
    carry.boom = np.where((carry.t > 6.0) & (carry.t < 8.0), -0.1, carry.boom)
    return carry


def only(told: list[Verdict]) -> Verdict:
    (verdict,) = told
    return verdict
