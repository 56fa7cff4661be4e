"""What hangs in the jaws, beside what tips the machine: a limiter of the load moment."""

from collections import deque
from collections.abc import Generator

import numpy as np

from executive.leaf.context import Context
from executive.leaf.outcome import Outcome
from executive.leaf.watched import guarded

# Share of the load that tips the machine at rest: 1.1 of the rated 75 % (ISO 10567), to which lifts
# are planned; EN 13000 asks that a limiter stops a crane between 1 and 1.1 of the rated capacity.
_MOST = 0.825
_OVER_S = 0.5  # half a sway, over which it is weighed: a rated load that sways is lifted


class LoadMoment:
    """Weighs what comes to hang in the jaws, and says when it is about to tip the machine.

    What a stone weighs is known by its volume alone before it hangs, and it may lie, after a fall
    for instance, where the machine may not lift it. Source: EN 474-5, which asks for a warning of
    overload, and EN 13000, which asks for a limiter that stops the motion of a crane.

    Args:
        context: The leaf's view of the mission. Where the base cannot tip, or no monitor weighs,
            no load is too much.

    Attributes:
        refusal: Why the load is too much; empty if it is not.
        hangs_kg: What hung in the jaws when it was last looked at, in the mean [kg].
        tipping_kg: The load that tips the machine there [kg].
    """

    def __init__(self, context: Context) -> None:
        from executive.machine.lift_capacity import LiftCapacity  # imports kinematics

        self._context, machine = context, context.machine()
        self._capacity = LiftCapacity(machine) if machine.stance.is_free else None
        self._told: deque[tuple[float, float]] = deque()
        self.refusal, self.hangs_kg, self.tipping_kg = "", 0.0, np.inf

    def limited(
        self, moving: Generator[None, None, Outcome[None]]
    ) -> Generator[None, None, Outcome[None]]:
        """Go through a motion, and fail once what hangs is about to tip the machine.

        Args:
            moving: The motion; it stops the arm when it is closed.
        """
        self._told.clear()
        return (yield from guarded(moving, self._look))

    def _look(self) -> str:
        self.refusal = self._refusal()
        return self.refusal

    def _refusal(self) -> str:
        now_s, mass_kg = self._context.now_s(), self._context.payload_kg()
        if self._capacity is None or mass_kg is None:
            return ""
        self._told.append((now_s, mass_kg))
        if now_s - self._told[0][0] < _OVER_S:
            return ""
        while now_s - self._told[0][0] > _OVER_S:
            self._told.popleft()
        self.hangs_kg = float(np.mean([one for _, one in self._told]))
        self.tipping_kg = self._capacity.at(self._context.arm()).tipping_kg
        if self.hangs_kg <= _MOST * self.tipping_kg:
            return ""
        hangs = f"{self.hangs_kg:.0f} kg hang in the jaws"
        return f"{hangs}, and {self.tipping_kg:.0f} kg tip the machine here"
