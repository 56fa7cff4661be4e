"""A long-lived process that holds a copy of one stateless plugin and computes its verbs."""

import multiprocessing as mp
import threading
from collections.abc import Sequence
from concurrent.futures import Future
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import Any

from executive.errors import RobotError
from executive.mission.assembly import Selections, assemble, needed_for

_DEADLINE_S = 2.0  # for a worker that is told to end, or to give a call up, before it is killed


class WorkerDiedError(RobotError):
    """A worker process ended in the middle of a call."""


class Worker:
    """Calls in order, one at a time; a worker that dies fails its call and is started anew for the
    next.
    """

    def __init__(self, capability: str, selections: Selections, model: str, seed: int) -> None:
        self._capability = capability
        self._arguments = (capability, needed_for(selections, capability), model, seed)
        self._calls: SimpleQueue[tuple[str, Sequence[Any], Future[Any]] | None] = SimpleQueue()
        self._computing: Future[Any] | None = None
        self._process: Any = None
        self._connection: Connection | None = None
        self._thread = threading.Thread(
            target=self._serve, name=f"{capability}-worker", daemon=True
        )
        self._thread.start()

    def submit(self, verb: str, args: Sequence[Any]) -> Future[Any]:
        """Queue a call."""
        future: Future[Any] = Future()
        self._calls.put((verb, args, future))
        return future

    def abandon(self, future: Future[Any]) -> None:
        """Give a call up: a process that is still at it at the deadline is killed, and the next one
        serves.
        """
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
        while (call := self._calls.get()) is not None:
            verb, args, future = call
            if future.set_running_or_notify_cancel():
                self._computing = future
                self._compute(verb, args, future)
                self._computing = None
        if self._connection is not None:
            self._connection.close()
        if self._process is not None:
            self._process.join(_DEADLINE_S)

    def _compute(self, verb: str, args: Sequence[Any], future: Future[Any]) -> None:
        try:
            connection = self._connected()
            connection.send((verb, tuple(args)))
            is_error, value = connection.recv()
        except (EOFError, OSError) as error:
            self._connection = None
            code = self._process.exitcode if self._process else None
            future.set_exception(
                WorkerDiedError(
                    f"the {self._capability} worker died in '{verb}' (exit {code}): {error}"
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
            verb, args = connection.recv()
            try:
                answer = (False, getattr(plugin, verb)(*args))
            except Exception as error:
                answer = (True, error)
            connection.send(answer)
    except (EOFError, OSError, KeyboardInterrupt):
        assembly.close()
