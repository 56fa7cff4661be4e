"""For how long the answer of a verb is awaited.

On the wall clock a limit is a time. In lock-step nothing waits for the answer but the mission
itself, and how long a verb takes on the wall depends on what else the computer does. So the limit
counts the processor time of the call there: a call is overdue when it has computed for so long, or
when that time has passed on the wall and it neither computes nor waits for a core. Time in which
this process itself was stopped, as by Ctrl-Z, says nothing of the call.
"""

from collections.abc import Callable

from executive.clock import wall_s

# Share of the time on the wall below which a call does not compute. Where the system does not tell
# how long a process was ready, and had no core, one that is ready gets more, up to twenty of them a
# core; one that sleeps, or waits for a lock, gets none.
_IDLE_SHARE = 0.05
_LEAST_SHARE = 0.1  # of the limit: the shortest time over which that share is taken
_LATE_SHARE = 0.5  # a look that is later than planned by that share of the wait tells nothing


class Patience:
    """Tells how long to wait for one call, from its beginning.

    Args:
        limit_s: The limit of the verb [s].
        spent_s: Returns the processor time of what computes the call [s]; none on the wall clock.
        ready_s: Returns for how long that was ready to compute and waited for a core [s].
        granted: Takes for how much longer the call is awaited, each time that it is [s].
    """

    def __init__(
        self,
        limit_s: float,
        spent_s: Callable[[], float] | None = None,
        ready_s: Callable[[], float] = float,
        granted: Callable[[float], None] = lambda more_s: None,
    ) -> None:
        self.limit_s = limit_s
        self._spent_s, self._ready_s, self._granted = spent_s, ready_s, granted
        self._ready_before_s = ready_s() if spent_s else 0.0
        self._begun_at_s = self._spent_before_s = spent_s() if spent_s else 0.0
        self._looked_s, self._wait_s = wall_s(), limit_s
        self._is_idle = False

    def more_s(self) -> float:
        """Return for how much longer to wait [s], once all that was waited for has passed.

        It is 0 if the call is overdue.
        """
        if self._spent_s is None:
            return 0.0
        now_s, spent_s, ready_s = wall_s(), self._spent_s(), self._ready_s()
        used_s = spent_s - self._spent_before_s + ready_s - self._ready_before_s
        passed_s = now_s - self._looked_s
        self._spent_before_s, self._ready_before_s, self._looked_s = spent_s, ready_s, now_s
        left_s = self.limit_s - (spent_s - self._begun_at_s)
        was_held_up = passed_s > (1.0 + _LATE_SHARE) * self._wait_s
        self._is_idle = used_s < _IDLE_SHARE * passed_s and not was_held_up
        if self._is_idle or left_s <= 0.0:
            return 0.0
        self._wait_s = max(left_s, _LEAST_SHARE * self.limit_s)
        self._granted(self._wait_s)
        return self._wait_s

    def told(self) -> str:
        """Say of an overdue call what it has failed to do."""
        within = f"no answer within {self.limit_s:g} s"
        if self._spent_s is None:
            return within
        if self._is_idle:
            return f"{within}, and it does not compute: it waits for something, or was stopped"
        return f"{within} of computing"
