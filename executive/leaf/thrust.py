"""Whether the ground pushes the tool up harder than the machine on its supports may bear."""

from collections import deque

import numpy as np

from executive.leaf.context import Context

_TICKS = 3  # over which the thrust is averaged: jaws vibrate as they come off a stone


class Thrust:
    """The thrust of jaws that press on what is beside or below them, while the arm rests.

    It is too much once it uses more than 0.45 of what holds the machine at rest about a side of its
    supports. Where no monitor weighs, or no supports are known, it never is.

    Args:
        context: The leaf's view of the mission, with the arm at rest.

    Attributes:
        was_too_much: Whether it was at one of the looks so far.
    """

    def __init__(self, context: Context) -> None:
        from executive.machine.tipping_moment import SHARE, TippingMoment  # imports kinematics

        self._context, self._q, machine = context, context.arm(), context.machine()
        self._moment = TippingMoment(machine) if machine.stance.supports_m else None
        if self._moment is not None:
            self._least_nm = (1.0 - SHARE) * self._moment.holding_nm(self._q, 0.0)
        self._told_kg = deque[float](maxlen=_TICKS)
        self.was_too_much = False

    def is_too_much(self) -> bool:
        """Weigh the tool once more, and return whether the thrust is too much; ask at each tick."""
        mass_kg = self._context.payload_kg()
        if self._moment is None or mass_kg is None:
            return False
        self._told_kg.append(mass_kg)
        if len(self._told_kg) < _TICKS:
            return False
        up_kg = min(float(np.mean(self._told_kg)), 0.0)
        is_too_much = bool((self._moment.holding_nm(self._q, up_kg) < self._least_nm).any())
        self.was_too_much |= is_too_much
        return is_too_much
