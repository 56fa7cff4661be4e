"""A long-lived process that holds a copy of one stateless plugin and computes its verbs."""

import multiprocessing as mp
import pickle
import threading
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import Any

from executive.errors import RobotError
from executive.interfaces.plugin import Plugin
from executive.mission.assembly import Assembly, Selections, assemble, needed_for
from executive.mission.fault import REMOTE, fault_of

_DEADLINE_S = 2.0  # for a worker to end, or to drop a call, before it is killed


@dataclass(frozen=True, slots=True)
class VerbCall:
    """One call of a plugin's verb: its name and arguments."""

    verb: str
    args: Sequence[Any]
    kwargs: Mapping[str, Any]

    def of(self, plugin: Plugin) -> Any:
        """VerbCall the verb of a plugin."""
        return getattr(plugin, self.verb)(*self.args, **self.kwargs)


class WorkerDiedError(RobotError):
    """A worker process ended in the middle of a call."""


class Worker:
    """Calls in order, one at a time; a worker that dies is restarted for the next call."""

    def __init__(self, capability: str, selections: Selections, model: str, seed: int) -> None:
        self._capability = capability
        self._arguments = (capability, needed_for(selections, capability), model, seed)
        self._calls: SimpleQueue[tuple[VerbCall, Future[Any]] | None] = SimpleQueue()
        self._computing: Future[Any] | None = None
        self._process: Any = None
        self._connection: Connection | None = None
        self._thread = threading.Thread(
            target=self._serve, name=f"{capability}-worker", daemon=True
        )
        self._thread.start()

    def submit(self, call: VerbCall) -> Future[Any]:
        """Queue a call."""
        future: Future[Any] = Future()
        self._calls.put((call, future))
        return future

    def abandon(self, future: Future[Any]) -> None:
        """Drop a call: a process that still computes it at the deadline is killed and replaced."""
        timer = threading.Timer(_DEADLINE_S, self._kill_if_at, [future])
        timer.daemon = True
        timer.start()

    def _kill_if_at(self, future: Future[Any]) -> None:
        if self._computing is future and self._process is not None:
            self._process.kill()

    def close(self) -> None:
        """End the process; killed if it is busy for longer than the deadline."""
        self._calls.put(None)
        self._thread.join(_DEADLINE_S)
        if self._process is not None and self._process.is_alive():
            self._process.kill()
            self._process.join()

    def _serve(self) -> None:
        while (queued := self._calls.get()) is not None:
            call, future = queued
            if future.set_running_or_notify_cancel():
                self._computing = future
                self._compute(call, future)
                self._computing = None
        if self._connection is not None:
            self._connection.close()
        if self._process is not None:
            self._process.join(_DEADLINE_S)

    def _compute(self, call: VerbCall, future: Future[Any]) -> None:
        try:
            connection = self._connected()
            connection.send(call)
            is_error, value = connection.recv()
        except (EOFError, OSError) as error:
            self._connection = None
            code = self._process.exitcode if self._process else None
            future.set_exception(
                WorkerDiedError(
                    f"the {self._capability} worker died in '{call.verb}' (exit {code}): {error}"
                )
            )
            return
        if is_error:
            future.set_exception(value)
        else:
            future.set_result(value)

    def _connected(self) -> Connection:
        if self._connection is None:
            context = mp.get_context(
                "spawn"
            )  # fork would copy threads and locks of numerical libraries
            self._connection, theirs = context.Pipe()
            self._process = context.Process(
                target=_work, args=(theirs, *self._arguments), daemon=True
            )
            self._process.start()
            theirs.close()
        return self._connection


def _work(
    connection: Connection, capability: str, selections: Selections, model: str, seed: int
) -> None:
    assembly = assemble(selections, model, seed)
    assembly.start()
    plugin = assembly.plugins[capability]
    try:
        while True:
            call: VerbCall = connection.recv()
            try:
                answer: tuple[bool, Any] = (False, call.of(plugin))
            except Exception as error:
                answer = (True, _portable(error, assembly))
            connection.send(answer)
    except (EOFError, OSError, KeyboardInterrupt):
        assembly.close()


def _portable(error: Exception, assembly: Assembly) -> Exception:
    """Return an error that can be sent, with the fault that it is: its frames cannot be sent."""
    fault = fault_of(error, assembly.plugins)
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # whatever an exception class of a plugin does when it is copied
        error = RobotError(f"{type(error).__name__}: {error}")
    setattr(error, REMOTE, fault)
    return error
