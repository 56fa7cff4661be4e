"""Where a verb is computed: the interface of runners, and the one that computes in the tick."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from executive.interfaces.plugin import Plugin
from executive.mission.jobs.alarm import Overdue, alarm
from executive.mission.jobs.call import Address, FunctionCall, VerbCall, VerbOverdueError
from executive.mission.jobs.notes import activity_of
from executive.mission.jobs.patience import Patience
from executive.mission.jobs.processor_time import ready_s
from executive.mission.jobs.stack import frames_of, place_among
from executive.supervision.beacon import beacon

_LATE_SHARE = 0.1  # of a limit that counts computing, by which a look at the call may come late


@dataclass(frozen=True, slots=True)
class Task:
    """A call that is to be computed.

    Attributes:
        address: The verb, as messages name it.
        plugin: The plugin in the mission's own process.
        call: The verb and its arguments.
        limit_s: Time after which it is overdue [s].
        counts_computing: That time is processor time, as in lock-step; else time on the wall.
    """

    address: Address
    plugin: Plugin
    call: VerbCall
    limit_s: float
    counts_computing: bool = False

    @property
    def is_beside(self) -> bool:
        """Whether a thread may compute it on the wall clock, though its plugin has state."""
        is_named = self.call.verb in self.plugin.beside_tick
        return (is_named or isinstance(self.call, FunctionCall)) and not self.counts_computing

    @property
    def is_awaited(self) -> bool:
        """Whether another process computes it, on the wall clock."""
        return self.plugin.is_remote and not self.counts_computing

    def patience(
        self, spent_s: Callable[[], float], ready_s: Callable[[], float] = ready_s
    ) -> Patience:
        """Return how long to wait, from now on; what the supervisor waits goes with it.

        Args:
            spent_s: Tells the processor time so far of what computes it [s].
            ready_s: Tells how long that has waited for a core [s]; the main thread by default.
        """
        counted_s = spent_s if self.counts_computing else None
        return Patience(self.limit_s, counted_s, ready_s, self._granted)

    def _granted(self, more_s: float) -> None:
        beacon().extend(id(self), self.watched_s(more_s))

    def watched_s(self, limit_s: float) -> float:
        """Return for how long the supervisor waits if the call is awaited for `limit_s` [s].

        In lock-step the computer may be busy, and a library that computes for a second then takes
        ten to return to Python, where the call would get more time, or be ended.
        """
        return limit_s * (1.0 + _LATE_SHARE) if self.counts_computing else limit_s

    def overdue(self, reason: str, place: str, trace: str) -> VerbOverdueError:
        """Return the error of a call that took longer than its limit, why, and where it was."""
        return self.address.error(VerbOverdueError, reason, place, trace)


@contextmanager
def noted(task: Task) -> Iterator[None]:
    """Tell the supervisor what this process computes, in case it does not survive it."""
    activity = activity_of(task.address, task.plugin)
    beacon().begin(id(task), activity, task.watched_s(task.limit_s))
    try:
        yield
    finally:
        beacon().end(id(task))


class Runner(ABC):
    """Decides where a verb is computed."""

    @abstractmethod
    def submit(self, task: Task) -> Future[Any]:
        """Begin a computation."""

    def prepare(self, capability: str) -> Future[Any] | None:
        """Begin to start what a capability's verbs are computed in, if that takes time."""
        return None

    def abandon(self, task: Task, future: Future[Any]) -> None:  # noqa: B027 - optional
        """Drop the result of a computation that has begun; by default it is left to end."""

    def close(self) -> None:  # noqa: B027 - optional
        """End what was begun."""


class InlineRunner(Runner):
    """Computes at once, in the tick."""

    def submit(self, task: Task) -> Future[Any]:
        future: Future[Any] = Future()
        patience = task.patience(time.process_time)
        try:
            with noted(task), alarm(patience):
                answer = task.call.of(task.plugin)
            future.set_result(answer)
        except Overdue as late:
            place, trace = place_among(frames_of(late), task.plugin)
            future.set_exception(task.overdue(patience.told(), place, trace))
        except Exception as error:
            future.set_exception(error)
        return future
