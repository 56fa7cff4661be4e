"""A long-lived process that holds a copy of one stateless plugin and computes its verbs."""

import pickle
import threading
from collections.abc import Callable
from concurrent.futures import Future
from queue import SimpleQueue
from typing import Any

from executive.errors import RobotError
from executive.events.mission import WorkerReplaced
from executive.machine.machine import Machine
from executive.mission.assembly import Selections
from executive.mission.jobs.call import (
    NotPortableError,
    VerbOverdueError,
    WorkerDiedError,
)
from executive.mission.jobs.limits import DEFAULT, Limits
from executive.mission.jobs.runner import Task
from executive.mission.jobs.serving import dumped
from executive.mission.jobs.stack import place_in_dump
from executive.mission.jobs.worker_process import EndedError, WorkerProcess

_DEADLINE_S = 2.0  # for a worker to end, or to drop a call, before it is killed


class Worker:
    """Calls in order, one at a time.

    A process that dies, exceeds its memory or does not answer in time is replaced, and its call is
    tried once more: the plugin is stateless, so that nothing is lost and nothing is done twice.
    """

    def __init__(
        self,
        capability: str,
        selections: Selections,
        machine: Machine,
        seed: int,
        limits: Limits = DEFAULT,
        tell: Callable[[WorkerReplaced], None] = lambda _: None,
    ) -> None:
        self._capability = capability
        self._name = selections[capability][0].name
        self._limits = limits
        self._tell = tell
        self._make: Callable[[], WorkerProcess] = lambda: WorkerProcess(
            capability, selections, machine, seed, limits
        )
        self._calls: SimpleQueue[tuple[Task | None, Future[Any]] | None] = SimpleQueue()
        self._computing: Future[Any] | None = None
        self._abandoned: Future[Any] | None = None
        self._process: WorkerProcess | None = None
        self._thread = threading.Thread(
            target=self._serve, name=f"{capability}-worker", daemon=True
        )
        self._thread.start()

    def submit(self, task: Task) -> Future[Any]:
        """Queue a call."""
        future: Future[Any] = Future()
        self._calls.put((task, future))
        return future

    def prepare(self) -> Future[Any]:
        """Start the process now; the future raises what kept it from starting."""
        future: Future[Any] = Future()
        self._calls.put((None, future))
        return future

    def abandon(self, future: Future[Any]) -> None:
        """Drop a call: a process that still computes it at the deadline is killed and replaced."""
        self._abandoned = future
        timer = threading.Timer(_DEADLINE_S, self._kill_if_at, [future])
        timer.daemon = True
        timer.start()

    def _kill_if_at(self, future: Future[Any]) -> None:
        process = self._process
        if self._computing is future and process is not None:
            process.interrupt()

    def close(self) -> None:
        """End the process; killed if it is busy for longer than the deadline."""
        self._calls.put(None)
        self._thread.join(_DEADLINE_S)
        process = self._process
        if self._thread.is_alive() and process is not None:
            process.interrupt()
            self._thread.join(_DEADLINE_S)

    def _serve(self) -> None:
        while (queued := self._calls.get()) is not None:
            task, future = queued
            if future.set_running_or_notify_cancel():
                self._computing = future
                try:
                    answer = self._started() if task is None else self._answer(task, future)
                except BaseException as error:  # whatever it is, the mission must not wait for ever
                    future.set_exception(error)
                else:
                    future.set_result(answer)
                self._computing = None
        if self._process is not None:
            self._process.close(_DEADLINE_S)

    def _answer(self, task: Task, future: Future[Any]) -> Any:
        request = _portable(task)
        try:
            return self._ask(task, request)
        except (WorkerDiedError, VerbOverdueError, MemoryError) as error:
            self._drop()
            if future is self._abandoned:
                raise
            self._told(task.call.verb, error)
        try:
            return self._ask(task, request)
        except (WorkerDiedError, VerbOverdueError, MemoryError):
            self._drop()
            raise

    def _ask(self, task: Task, request: bytes) -> Any:
        """Return what the verb returned in the process, or raise what it raised there."""
        process = self._started()
        patience = task.patience(process.spent_s, process.ready_s)
        try:
            raw = process.ask(request, patience)
        except TimeoutError:
            reason, dump = process.stopped() or patience.told(), process.dump()
            raise task.overdue(reason, place_in_dump(dump, task.plugin), dump) from None
        except EndedError as ended:
            place = place_in_dump(ended.dump, task.plugin)
            raise task.address.error(WorkerDiedError, str(ended), place, ended.dump) from None
        try:
            is_error, value = pickle.loads(raw)
        except Exception as error:  # whatever a class does when it is made from its pickle
            reason = f"its answer cannot be read: {type(error).__name__}: {error}"
            raise task.address.error(NotPortableError, reason) from error
        if is_error:
            raise value
        return value

    def _started(self) -> WorkerProcess:
        """Return a process that lives and has started its plugin.

        Raises:
            WorkerDiedError: If it ends before that, or takes too long.
            Exception: What the plugin raised while it was made or started.
        """
        if self._process is not None and not self._process.is_alive():
            self._told("", "it ended between two calls")
            self._drop()
        if self._process is None:
            self._process = self._make()
            try:
                self._process.start()
            except (EndedError, TimeoutError, OSError) as error:
                self._drop()
                raise WorkerDiedError(
                    f"the worker process of the {self._capability} plugin '{self._name}' did not "
                    f"start: {str(error) or f'not ready within {self._limits.start_s:g} s'}"
                ) from error
            except Exception:
                self._drop()
                raise
        return self._process

    def _drop(self) -> None:
        if self._process is not None:
            self._process.kill()
        self._process = None

    def _told(self, verb: str, reason: object) -> None:
        text = reason if isinstance(reason, RobotError | str) else f"{type(reason).__name__}"
        self._tell(WorkerReplaced(self._capability, self._name, verb, str(text)))


def _portable(task: Task) -> bytes:
    try:
        return dumped(task.call)
    except Exception as error:  # whatever a class does when it is pickled
        reason = f"an argument cannot be sent to a worker process: {type(error).__name__}: {error}"
        raise task.address.error(NotPortableError, reason) from error
