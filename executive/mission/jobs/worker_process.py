"""The mission's end of a worker process: starts it, asks it, and ends it."""

import contextlib
import multiprocessing as mp
import os
import pickle
import signal
import tempfile
import threading
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import psutil

from executive.clock import wall_s
from executive.machine.machine import Machine
from executive.mission.assembly import Selections
from executive.mission.jobs.limits import Limits
from executive.mission.jobs.patience import Patience
from executive.mission.jobs.processor_time import ready_s
from executive.mission.jobs.serving import serve

_DUMP_S = 0.2  # for the call stack of a process that hangs to be written; it takes 1 ms
_EXIT_S = 2.0  # for the exit status of a process that has closed its connection
_WAKE_S = 0.01


class EndedError(Exception):
    """The process has ended; `dump` is the call stack that it left, if it did."""

    def __init__(self, reason: str, dump: str) -> None:
        super().__init__(reason)
        self.dump = dump


class WorkerProcess:
    """One process with one plugin, forked from a server that has imported it.

    The server has no threads of numerical libraries, whose locks a fork would copy.
    """

    def __init__(
        self, capability: str, selections: Selections, machine: Machine, seed: int, limits: Limits
    ) -> None:
        handle, name = tempfile.mkstemp(prefix="executive-worker-", suffix=".stack")
        os.close(handle)
        self._stack = Path(name)
        self._limits = limits
        self._arguments = (capability, selections, machine, seed, limits.memory_bytes, self._stack)
        self._process: Any = None
        self._spent_s = 0.0
        self._connection: Connection | None = None

    def start(self) -> None:
        """Start the process and wait until its plugin is started.

        Raises:
            EndedError: If it ends before that.
            TimeoutError: If it takes longer than the limit.
            OSError: If the system starts no process.
            Exception: What the plugin raised while it was made or started.
        """
        context = mp.get_context("forkserver")
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs, *self._arguments), daemon=True)
        self._process.start()
        theirs.close()
        error = pickle.loads(self._received(Patience(self._limits.start_s)))
        if error is not None:
            raise error

    def ask(self, request: bytes, patience: Patience) -> bytes:
        """Send a pickled call and return its pickled answer.

        Raises:
            EndedError: If the process ends before it has answered.
            TimeoutError: If it has not answered in time.
        """
        try:
            self._open().send_bytes(request)
        except OSError as error:
            raise self._ended() from error
        return self._received(patience)

    def spent_s(self) -> float:
        """Return the processor time of the process so far [s]; the last one once it has ended."""
        with contextlib.suppress(psutil.Error):
            spent = psutil.Process(self._process.pid).cpu_times()
            self._spent_s = float(spent.user + spent.system)
        return self._spent_s

    def ready_s(self) -> float:
        """Return for how long the process has waited for a core so far [s]."""
        return ready_s(self._process.pid) if self._process.pid else 0.0

    def stopped(self) -> str:
        """Return that a signal has stopped the process, and the cure; empty if none has."""
        with contextlib.suppress(psutil.Error):
            process = psutil.Process(self._process.pid)
            if process.status() == psutil.STATUS_STOPPED:
                return (
                    f"no answer: its worker process {process.pid} was stopped by a signal (SIGSTOP "
                    "or SIGTSTP), from outside of the mission"
                )
        return ""

    def is_alive(self) -> bool:
        """Whether the process runs."""
        return self._process is not None and bool(self._process.is_alive())

    def dump(self) -> str:
        """Return the call stack of a process that hangs, as faulthandler writes it.

        It is written by a signal handler in C, also while a library holds the interpreter's lock.
        """
        with contextlib.suppress(OSError):
            os.kill(self._process.pid, signal.SIGUSR1)
        limit_s, text = wall_s() + _DUMP_S, ""
        while wall_s() < limit_s and not (text and text == self._left()):
            text = self._left()
            threading.Event().wait(_WAKE_S)
        return text

    def interrupt(self) -> None:
        """End the process at once, from another thread than the one that asks it.

        Whoever waits for its answer gets an EndedError and releases what the process held.
        """
        if self._process is not None and self._process.pid is not None:
            self._process.kill()

    def kill(self) -> None:
        """End the process at once, and release what it held."""
        if self._process is not None and self._process.pid is not None:
            self._process.kill()
            self._process.join(_EXIT_S)
        self._release()

    def close(self, limit_s: float) -> None:
        """Let the process close its plugin and end; after the limit, kill it."""
        if self._connection is not None:
            self._connection.close()
        if self._process is not None and self._process.pid is not None:
            self._process.join(limit_s)
        self.kill()

    def _received(self, patience: Patience) -> bytes:
        connection, wait_s = self._open(), patience.limit_s
        try:
            while not connection.poll(wait_s):
                wait_s = patience.more_s()
                if not wait_s:
                    raise TimeoutError
            return connection.recv_bytes()
        except (EOFError, ConnectionError) as error:
            raise self._ended() from error

    def _open(self) -> Connection:
        if self._connection is None:
            raise EndedError("the process was not started", "")
        return self._connection

    def _ended(self) -> EndedError:
        self._process.join(_EXIT_S)
        return EndedError(f"its worker process {_ending(self._process.exitcode)}", self._left())

    def _left(self) -> str:
        try:
            return self._stack.read_text(encoding="utf-8", errors="replace")
        except OSError:
            return ""

    def _release(self) -> None:
        self._stack.unlink(missing_ok=True)
        if self._connection is not None:
            self._connection.close()


def _ending(code: int | None) -> str:
    if code is None:
        return "closed its connection"
    if code < 0:
        return f"was ended by {signal.Signals(-code).name}"
    return f"ended with exit status {code}"
