"""Whether the ground pushes the tool up harder than the machine on its supports may bear."""

from collections import deque

import numpy as np

from executive.leaf.context import Context

_TICKS = 3  # over which the thrust is averaged: jaws vibrate as they come off a stone


class Thrust:
    """The thrust of jaws that press on what is beside or below them, while the arm rests.

    It is too much once it uses more than 0.45 of what holds the machine at rest about a side of its
    supports. What weighs on the tool as the jaws begin to move is no thrust of theirs, nor is what
    a robot without efforts is told to weigh. Where no monitor weighs, or no supports are known, it
    never is.

    Args:
        context: The leaf's view of the mission, with the arm at rest.

    Attributes:
        was_too_much: Whether it was at one of the looks of this drive of the jaws.
    """

    def __init__(self, context: Context) -> None:
        from executive.machine.tipping_moment import SHARE, TippingMoment  # imports kinematics

        self._context, self._left = context, 1.0 - SHARE
        machine = context.machine()
        self._moment = TippingMoment(machine) if machine.stance.supports_m else None
        self._begun_kg, self._told_kg = list[float](), deque[float](maxlen=_TICKS)
        self.was_too_much = False

    def begin_drive(self) -> None:
        """Forget the looks of the drive before, but for what weighed on the tool at first."""
        self._told_kg.clear()
        self.was_too_much = False

    def is_too_much(self) -> bool:
        """Weigh the tool once more, and return whether the thrust is too much; ask at each tick."""
        mass_kg = self._context.payload_kg()
        if self._moment is None or mass_kg is None:
            return False
        if len(self._begun_kg) < _TICKS:
            self._begun_kg.append(mass_kg)
        self._told_kg.append(mass_kg)
        if len(self._told_kg) < _TICKS:
            return False
        added_kg = min(float(np.mean(self._told_kg) - np.mean(self._begun_kg)), 0.0)
        q, moment = self._context.arm(), self._moment
        least_nm = self._left * moment.holding_nm(q, 0.0)
        is_too_much = bool((moment.holding_nm(q, added_kg) < least_nm).any())
        self.was_too_much |= is_too_much
        return is_too_much
