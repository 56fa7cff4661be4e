"""How quickly a motion with a load may stop on a machine that stands on supports that yield."""

import numpy as np

from executive.arrays import Float
from executive.machine.machine import Machine
from executive.machine.stance import SLOWEST_S
from executive.machine.sway import Sway
from executive.machine.tipping_moment import SHARE, TippingMoment

_LOOKS = 20  # postures of a path that are looked at
_SURGE = 2.0  # a force that sets in at once moves a spring by twice what it does at rest


class LoadedStop:
    """The least time of a stop that leaves a machine on its supports.

    Args:
        machine: The machine, with its points of support and their stiffness.
    """

    def __init__(self, machine: Machine) -> None:
        self._sway, self._moment = Sway(machine), TippingMoment(machine)

    def least_s(self, positions: Float, velocities: Float, load_kg: float) -> float:
        """Return the least time in which a stop in mid-motion takes its whole speed away [s].

        The speed falls evenly. What moves presses on about each side of the area of support with
        its momentum over the time of the stop, and a spring makes twice of that. A stop within less
        than the period of the sway presses with the momentum times its angular frequency at most:
        where the machine bears that, it may be as quick as the joints may. Elsewhere it takes a
        period at least, after which no sway is left.

        Args:
            positions: Positions of the arm's joints along the path [rad] or [m], shape (m, n).
            velocities: Their velocities, shape (m, n).
            load_kg: A point mass at the grasp centre [kg].

        Returns:
            That time, at most `SLOWEST_S`; 0 where only the joints limit it.
        """
        few = np.unique(np.linspace(0, len(positions) - 1, _LOOKS).round().astype(int))
        return max(self._at(positions[i], velocities[i], load_kg) for i in few)

    def _at(self, q: Float, dq: Float, load_kg: float) -> float:
        spare_nm = SHARE * self._moment.holding_nm(q, load_kg)
        momentum = np.abs(self._moment.momentum(q, dq, load_kg))  # a sway presses to both sides
        period_s = self._sway.period_s(q, load_kg)
        if (2 * np.pi / period_s * momentum <= spare_nm).all():
            return 0.0
        if spare_nm.min() <= 0.0:
            return SLOWEST_S
        return float(np.clip((_SURGE * momentum / spare_nm).max(), period_s, SLOWEST_S))
