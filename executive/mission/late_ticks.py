"""Late ticks of a mission on the wall clock: counted, told, and too many in a row end it."""

import math

from executive.errors import ExecutiveError
from executive.events.mission import TickLate
from executive.interfaces.report import LateTicksReport
from executive.machine.machine import Machine


class LateTicksError(ExecutiveError):
    """The loop does not keep its period."""


class LateTicks:
    """Counts ticks that took longer than the period.

    Attributes:
        count: Number of late ticks.
        worst_s: By how much the worst was late [s].
    """

    def __init__(self, tick_s: float, limit: int | None, machine: Machine) -> None:
        self._tick_s = tick_s
        # A loop that is late for as long as the machine needs for a stop has lost control of it.
        self.limit = limit or max(2, math.ceil(machine.stop_s(machine.arm_names) / tick_s))
        self._in_a_row = 0
        self.count = 0
        self.worst_s = 0.0

    def add(self, late_s: float) -> TickLate | None:
        """Take by how much a tick was late [s]; return the event, None if it was in time."""
        if late_s <= 0.0:
            self._in_a_row = 0
            return None
        self._in_a_row += 1
        self.count += 1
        self.worst_s = max(self.worst_s, late_s)
        return TickLate(round(late_s, 6), self._in_a_row)

    def check(self) -> None:
        """Look at the late ticks in a row.

        Raises:
            LateTicksError: If there are too many.
        """
        if self._in_a_row >= self.limit:
            raise LateTicksError(
                f"{self._in_a_row} ticks in a row took longer than their {self._tick_s:g} s (the "
                f"worst by {self.worst_s:.2f} s): compute long verbs in worker processes "
                "(--runner process), or allow more time by loop.tick or loop.late_ticks"
            )

    def as_report(self) -> LateTicksReport:
        """Return the figures of the report."""
        return LateTicksReport(self.count, round(self.worst_s, 3), self.limit)
