"""Whether the ground or a stone pushes the tool harder than the machine on its supports bears."""

from collections import deque

import numpy as np

from executive.arrays import Float
from executive.leaf.context import Context
from executive.leaf.sudden_load import SuddenLoad

_TICKS = 3  # over which efforts are averaged: jaws vibrate as they come off a stone


class Thrust:
    """The thrust of jaws that press on what is beside or below them, while the arm rests.

    It is the force on the tool, upwards and to the sides, that explains by how much the efforts of
    the arm have changed since the jaws began to move; what hangs in them is none. It is too much
    once its moment about a side of the supports is more than 0.4 of what holds the machine there.
    Where no supports are known, or a robot tells no efforts, it never is.

    Args:
        context: The leaf's view of the mission, with the arm at rest.

    Attributes:
        was_too_much: Whether it was at one of the looks of this drive of the jaws.
        is_too_sudden: Whether what hangs in the jaws came on too suddenly at the last look.
        waited_s: For how long it has been so at all looks [s].
    """

    def __init__(self, context: Context) -> None:
        from executive.machine.tipping_moment import SHARE, TippingMoment  # imports kinematics
        from executive.machine.tool_force import ToolForce

        self._context, self._share, machine = context, SHARE, context.machine()
        self._force = ToolForce(machine)
        self._moment = TippingMoment(machine) if machine.stance.supports_m else None
        self._begun, self._told = list[Float](), deque[Float](maxlen=_TICKS)
        self._load = SuddenLoad(context)
        self.was_too_much = self.is_too_sudden = False

    @property
    def waited_s(self) -> float:
        return self._load.waited_s

    def begin_drive(self) -> None:
        """Forget the looks of the drive before, but for the efforts at first."""
        self._told.clear()
        self.was_too_much = self.is_too_sudden = False

    def is_too_much(self) -> bool:
        """Look at the efforts once more, and return whether it is too much; ask at each tick."""
        if self._moment is None:
            return False
        joints = self._context.joints()
        effort = np.array([joints.of(name)[2] for name in self._context.machine().arm_names])
        if len(self._begun) < _TICKS:
            self._begun.append(effort)
        self._told.append(effort)
        if len(self._told) < _TICKS:
            return False
        q, added = self._context.arm(), np.mean(self._told, axis=0) - np.mean(self._begun, axis=0)
        force_n = self._force.explaining(q, added)
        self.is_too_sudden = self._load.is_too_sudden(self._context.now_s(), q, force_n)
        force_n[2] = max(force_n[2], 0.0)
        most_nm = self._share * self._moment.holding_nm(q, 0.0)
        is_too_much = bool((self._moment.tipping_nm(q, force_n) > most_nm).any())
        self.was_too_much |= is_too_much
        return is_too_much
