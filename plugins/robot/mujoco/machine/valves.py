"""Valves between a command and the oil: dead time, dead band, first-order lag, one pump for all."""

from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.machine.hydraulics import Hydraulics
from executive.machine.machine import Machine


class KeptValves(TypedDict):
    """The commands under way and the speeds."""

    sent: Float
    lagged: Float
    speed: Float


class Valves:
    """The valves of one machine, whose figures differ from those that its controller knows.

    They are load-sensing: with pressure compensators the flow does not depend on the load. The flow
    of the pump is divided in proportion when the joints ask for more than it gives.

    Attributes:
        speed: Speeds of the joints that the oil has now [rad/s] or [m/s], shape (n,).
    """

    def __init__(
        self, hydraulics: Hydraulics, machine: Machine, step_s: float, rng: np.random.Generator
    ) -> None:
        n = len(machine.joints)
        own = 1.0 + hydraulics.spread * rng.uniform(-1.0, 1.0, (3, n))
        self._delay = hydraulics.dead_time_s * own[0] / step_s
        self._follow = 1.0 - np.exp(-2 * np.pi * hydraulics.lag_hz * own[1] * step_s)
        self._dead_band = hydraulics.dead_band * own[2]
        self._step_s, self._full = step_s, hydraulics.valve_margin * machine.max_velocity
        self._displacement = np.array([hydraulics.displacement[j] for j in machine.arm_names])
        self._pump_m3_s = hydraulics.pump_flow_m3_s
        # Commands of the last steps, the newest first: all that is still under way.
        self._sent = np.zeros((int(np.ceil(self._delay.max())) + 2, n))
        self._lagged = np.zeros(n)
        self.speed = np.zeros(n)

    def step(self, command: Float) -> None:
        """Advance by one integration step with commands from -1 to 1, shape (n,)."""
        self._sent = np.vstack([command, self._sent[:-1]])
        whole = np.floor(self._delay).astype(np.int64)
        part, joints = self._delay - whole, np.arange(len(whole))
        arrived = (1 - part) * self._sent[whole, joints] + part * self._sent[whole + 1, joints]
        open_share = np.maximum(np.abs(arrived) - self._dead_band, 0.0) / (1 - self._dead_band)
        target = np.sign(arrived) * open_share * self._full
        self._lagged = self._lagged + self._follow * (target - self._lagged)
        asked_m3_s = float(self._displacement @ np.abs(self._lagged))
        self.speed = self._lagged * min(1.0, self._pump_m3_s / max(asked_m3_s, 1e-9))

    def keep(self) -> KeptValves:
        """Return the commands under way and the speeds."""
        return {"sent": self._sent, "lagged": self._lagged, "speed": self.speed}

    def restore(self, kept: KeptValves) -> None:
        """Take back what `keep` returned."""
        self._sent, self._lagged, self.speed = kept["sent"], kept["lagged"], kept["speed"]
