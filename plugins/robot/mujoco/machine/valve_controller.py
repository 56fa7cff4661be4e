"""The controller of hydraulic joints: feed-forward of the inverse valve, and a Smith predictor."""

from collections import deque
from collections.abc import Sequence
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.machine.hydraulics import Hydraulics
from executive.machine.machine import Machine

PERIOD_S = 0.01
_FLOW_SHARE = 0.9  # of the pump's flow that references use; feedback has the rest
# Position error, in steps of the encoder, below which a joint that shall stand is left alone:
# feedback within the dead band would swing about the goal for ever.
_AT_GOAL_STEPS = 1.5
_SMALL = 0.3  # share of the full speed below which the dead band tells
_LEARNING_HZ = 0.5  # slow beside the loop, which is closed at some 0.5 Hz
_STANDING = 1e-6  # speed of a reference that stands [rad/s] or [m/s]


class KeptController(TypedDict):
    """What the next command depends on."""

    before: Float
    model: tuple[Float, Float]
    under_way: Sequence[Float]
    references: Sequence[Float]
    wanted: Sequence[Float]
    learned: tuple[Float, Float]


class ValveController:
    """Computes commands of the valves from a reference, measured positions and a known valve.

    The arm follows its reference one dead time late, and apart from that without a lag by design:
    with reference q(t), the commanded speed is q'(t) + T q''(t), the inverse of the lag T, plus
    feedback of the error one dead time ahead. The position there is predicted from the measured
    one and the commands that are still under way (O. J. M. Smith, "Closer control of loops with
    dead time", Chemical Engineering Progress 1957). The gain 1 / (2 T) damps the loop of lag and
    integrator by 0.7. The dead band is added to every command.
    """

    def __init__(self, hydraulics: Hydraulics, machine: Machine, position: Float) -> None:
        """Take a machine at rest at a position, shape (n,)."""
        n = len(position)
        self._lag_s = 1.0 / (2 * np.pi * hydraulics.lag_hz)
        self._gain = 1.0 / (2 * self._lag_s)
        self._follow = 1.0 - np.exp(-PERIOD_S / self._lag_s)
        self._full = hydraulics.valve_margin * machine.max_velocity
        self._known_band = hydraulics.dead_band
        self._dead_band = np.full(n, hydraulics.dead_band)
        self._displacement = np.array([hydraulics.displacement[j] for j in machine.arm_names])
        self._flow_m3_s = _FLOW_SHARE * hydraulics.pump_flow_m3_s
        is_length = np.array([joint.kind == "prismatic" for joint in machine.joints])
        self._steps = np.where(is_length, hydraulics.length_step_m, hydraulics.angle_step_rad)
        periods = round(hydraulics.dead_time_s / PERIOD_S)
        self._before = np.zeros(n)  # velocity of the last reference
        self._speed, self._moved = np.zeros(n), np.zeros(n)  # of the model without dead time
        # From the move before the one that the joints have just made to the newest.
        self._under_way = deque([np.zeros(n)] * (periods + 2), maxlen=periods + 2)
        # Read after a period, when the newest reference is one period old already.
        self._references = deque([np.array(position)] * periods, maxlen=periods)
        self._wanted = deque([np.zeros(n)] * (periods + 1), maxlen=periods + 1)
        self._last = self.measured(position)

    def pace(self, velocity: Float) -> float:
        """Return the share of its speed at which a reference has enough flow, at most 1."""
        return min(1.0, self._flow_m3_s / max(float(self._displacement @ np.abs(velocity)), 1e-9))

    def due(self) -> Float:
        """Return where the arm shall be now: the reference one dead time ago, shape (n,)."""
        return np.array(self._references[0])

    def measured(self, position: Float) -> Float:
        """Return positions as the encoders resolve them, shape (n,)."""
        return quantised(position, self._steps)

    def command(self, position: Float, velocity: Float, measured: Float) -> Float:
        """Return commands from -1 to 1 for one control period, shape (n,).

        Args:
            position: The reference now, shape (n,).
            velocity: Its velocity, shape (n,).
            measured: Measured positions, shape (n,).
        """
        self._learn(measured)
        acceleration = (velocity - self._before) / PERIOD_S
        self._before = np.array(velocity)
        self._references.append(np.array(position))
        predicted = measured + self._moved - self._under_way[1]
        error = position - predicted
        error[(np.abs(velocity) < _STANDING) & (np.abs(error) < _AT_GOAL_STEPS * self._steps)] = 0.0
        wanted = velocity + self._lag_s * acceleration + self._gain * error
        wanted = np.clip(wanted, -self._full, self._full)
        self._speed = self._speed + self._follow * (wanted - self._speed)
        self._moved = self._moved + PERIOD_S * self._speed
        self._under_way.append(self._moved)
        self._wanted.append(wanted)
        opened = self._dead_band + (1 - self._dead_band) * np.abs(wanted) / self._full
        return np.asarray(np.sign(wanted) * opened)

    def _learn(self, measured: Float) -> None:
        """Compare what the joints moved within the last period with what the model has moved.

        Both are of commands of one dead time before. A gradient step on the difference: a dead band
        that is larger than known by d makes the joint slower by d of its full speed.
        """
        wanted = self._wanted[0]
        less = (self._under_way[1] - self._under_way[0]) - (measured - self._last)
        is_small = np.abs(wanted) < _SMALL * self._full
        step = np.where(is_small, _LEARNING_HZ * np.sign(wanted) * less / self._full, 0.0)
        self._dead_band = np.clip(self._dead_band + step, 0.0, 2 * self._known_band)
        self._last = measured

    def keep(self) -> KeptController:
        """Return what the next command depends on."""
        return {
            "before": self._before,
            "model": (self._speed, self._moved),
            "under_way": list(self._under_way),
            "references": list(self._references),
            "wanted": list(self._wanted),
            "learned": (self._dead_band, self._last),
        }

    def restore(self, kept: KeptController) -> None:
        """Take back what `keep` returned."""
        self._before = kept["before"]
        self._speed, self._moved = kept["model"]
        self._under_way.extend(kept["under_way"])
        self._references.extend(kept["references"])
        self._wanted.extend(kept["wanted"])
        self._dead_band, self._last = kept["learned"]


def quantised(position: Float, steps: Float) -> Float:
    """Return positions rounded to the steps of their encoders; a step of 0 rounds nothing."""
    whole = np.where(steps > 0, steps, 1.0)
    return np.where(steps > 0, np.round(position / whole) * whole, position)
