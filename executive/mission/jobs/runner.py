"""Where a verb is computed: the interface of runners, and the one that computes in the tick."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from executive.interfaces.plugin import Plugin
from executive.mission.jobs.alarm import Overdue, alarm
from executive.mission.jobs.call import Address, VerbCall, VerbOverdueError
from executive.mission.jobs.stack import folder_of, frames_of, place_among
from executive.supervision.beacon import beacon


@dataclass(frozen=True, slots=True)
class Task:
    """A call that is to be computed.

    Attributes:
        address: The verb, as messages name it.
        plugin: The plugin in the mission's own process.
        call: The verb and its arguments.
        limit_s: Computing time after which it is overdue [s].
    """

    address: Address
    plugin: Plugin
    call: VerbCall
    limit_s: float

    def overdue(self, place: str, trace: str) -> VerbOverdueError:
        """Return the error of a call that took longer than its limit, and where it was then."""
        reason = f"no answer within {self.limit_s:g} s of computing"
        return self.address.error(VerbOverdueError, reason, place, trace)


@contextmanager
def noted(task: Task) -> Iterator[None]:
    """Tell the supervisor what this process computes, in case it does not survive it."""
    address = task.address
    activity = {
        "component": f"{address.capability} plugin '{address.name}'",
        "capability": address.capability,
        "name": address.name,
        "verb": address.verb,
        "place": address.place,
        "folder": folder_of(task.plugin),
    }
    beacon().begin(activity, task.limit_s)
    try:
        yield
    finally:
        beacon().end()


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
        try:
            with noted(task), alarm(task.limit_s):
                answer = task.call.of(task.plugin)
            future.set_result(answer)
        except Overdue as late:
            place, trace = place_among(frames_of(late), task.plugin)
            future.set_exception(task.overdue(place, trace))
        except Exception as error:
            future.set_exception(error)
        return future
