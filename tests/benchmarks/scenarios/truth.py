"""Where the machine's bodies and sensors truly are, at the inertial samples and between."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float
from executive.machine.machine import Machine
from scenarios.motion import Motion

RATE_HZ = 100
_STEP_S = 1e-4  # of central differences: a micrometre a second at 1 m/s² of change


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Poses of the cabin by time, and of the chassis below it."""

    machine: Machine
    motion: Motion

    def T_map_base(self, t: Float) -> Float:
        """Return the chassis, shape (n, 4, 4)."""
        T = np.tile(np.eye(4), (len(t), 1, 1))
        T[:, :3, :3], T[:, :3, 3] = self.motion.R_map_base(t), self.motion.p_map_base(t)
        return T

    def T_map_cabin(self, t: Float) -> Float:
        """Return the cabin, shape (n, 4, 4)."""
        return np.asarray(
            self.T_map_base(t)
            @ self.machine.joints[0].T_parent_joint
            @ _about_z(self.motion.turn(t)[0])
        )

    def T_map_sensor(self, name: str, t: Float) -> Float:
        """Return a sensor on the cabin or on the chassis, shape (n, 4, 4)."""
        sensor = self.machine.sensors[name]
        T_map_link = (
            self.T_map_cabin(t) if sensor.link == self.machine.cabin_link else self.T_map_base(t)
        )
        return np.asarray(T_map_link @ sensor.T_link_sensor)

    def velocity(self, name: str, t: Float) -> Float:
        """Return the velocity of a sensor in map axes [m/s], shape (n, 3)."""
        after, before = (self.T_map_sensor(name, t + h)[:, :3, 3] for h in (_STEP_S, -_STEP_S))
        return np.asarray((after - before) / (2 * _STEP_S))


def _about_z(angle: Float) -> Float:
    T = np.tile(np.eye(4), (len(angle), 1, 1))
    T[:, 0, 0] = T[:, 1, 1] = np.cos(angle)
    T[:, 1, 0] = np.sin(angle)
    T[:, 0, 1] = -T[:, 1, 0]
    return T
