"""Late ticks of a mission on the wall clock: counted, told, and too many in a row end it."""

import math
from collections import Counter
from collections.abc import Sequence

from executive.errors import ExecutiveError
from executive.events.mission import TickLate
from executive.interfaces.report import LateTicksReport
from executive.machine.machine import Machine
from executive.mission.tick_times import WAKE, Share


class LateTicksError(ExecutiveError):
    """The loop does not keep its period."""


class LateTicks:
    """Counts ticks that took longer than the period, by what took the time.

    Attributes:
        count: Number of late ticks.
        worst_s: By how much the worst was late [s].
    """

    def __init__(self, tick_s: float, limit: int | None, machine: Machine) -> None:
        self._tick_s = tick_s
        # A loop that is late for as long as the machine needs for a stop has lost control of it.
        self.limit = limit or max(2, math.ceil(machine.stop_s(machine.arm_names) / tick_s))
        self._in_a_row = 0
        self._causes: Counter[str] = Counter()
        self._worst_cause = ""
        self.count = 0
        self.worst_s = 0.0

    def add(self, late_s: float, shares: Sequence[Share]) -> TickLate | None:
        """Take by how much a tick was late, and why; return the event, None if it was in time.

        Args:
            late_s: By how much it was late [s].
            shares: What its steps took.
        """
        if late_s <= 0.0:
            self._in_a_row = 0
            return None
        self._in_a_row += 1
        slowest = self._slowest(late_s, shares)
        event = TickLate(
            late_s=round(late_s, 6),
            in_a_row=self._in_a_row,
            step=slowest.step,
            in_node=slowest.node,
            took_s=round(slowest.took_s, 6),
            computed_s=round(slowest.computed_s, 6),
        )
        self.count += 1
        self._causes[event.cause] += 1
        if late_s > self.worst_s:
            self.worst_s, self._worst_cause = late_s, event.cause
        return event

    def check(self) -> None:
        """Look at the late ticks in a row.

        Raises:
            LateTicksError: If there are too many.
        """
        if self._in_a_row >= self.limit:
            cause, times = self._causes.most_common(1)[0]
            raise LateTicksError(
                f"{self._in_a_row} ticks in a row took longer than their {self._tick_s:g} s (the "
                f"worst by {self.worst_s:.2f} s, for {self._worst_cause}; {times} of {self.count} "
                f"for {cause}): compute long verbs in worker processes (--runner process), or "
                "allow more time by loop.tick or loop.late_ticks"
            )

    def as_report(self) -> LateTicksReport:
        """Return the figures of the report."""
        causes = dict(self._causes.most_common())
        return LateTicksReport(
            self.count, round(self.worst_s, 3), self.limit, self._worst_cause, causes
        )

    def _slowest(self, late_s: float, shares: Sequence[Share]) -> Share:
        """Return what took the most of a late tick, from the moment at which it was to begin."""
        before_s = late_s + self._tick_s - sum(one.took_s for one in shares)
        waking = Share(WAKE, "", max(before_s, 0.0), 0.0)
        return max([waking, *shares], key=lambda one: one.took_s)
