"""The campaign's end of a fork server: starts it, asks it for runs, keeps what it reports."""

import os
import subprocess
import tempfile
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import wait
from threading import RLock

from executive.campaign.execution.processes.fork_protocol import Begin, Begun, Exited
from executive.campaign.execution.processes.process_ties import python_command

# One thread for each numerical library: runs side by side otherwise wait for one another.
ONE_THREAD = dict.fromkeys(
    (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "NUMEXPR_NUM_THREADS",
        "NUMBA_NUM_THREADS",
    ),
    "1",
)
_SERVER = "executive.campaign.execution.processes.fork_server"
_DEADLINE_S = 5.0  # for the server to end
_SHOWN_BYTES = 2000  # of what the server printed


class ForkClient:
    """A fork server with what it has reported; several threads may use it."""

    def __init__(self) -> None:
        self._lock = RLock()
        self._pids: dict[int, int] = {}
        self._exits: dict[int, Exited] = {}
        self._is_alive = True
        self._last_printed = ""
        self._printed = tempfile.TemporaryFile()  # noqa: SIM115 - open as long as the server is
        self._connection, theirs = Pipe()
        self._process = subprocess.Popen(
            python_command(_SERVER, str(theirs.fileno())),
            stdin=subprocess.DEVNULL,
            stdout=self._printed,
            stderr=self._printed,
            pass_fds=[theirs.fileno()],
            env=os.environ | ONE_THREAD,
            start_new_session=True,  # Ctrl-C at a terminal reaches the campaign alone
        )
        theirs.close()

    @property
    def is_alive(self) -> bool:
        """Whether the server can be asked; when it ends, all its runs end."""
        return self._is_alive

    def begin(self, asked: Begin) -> None:
        """Ask for a run; if the server has ended, `is_alive` says so afterwards."""
        with self._lock:
            try:
                self._connection.send(asked)
            except OSError:
                self._is_alive = False

    def wait(self, timeout_s: float) -> None:
        """Wait until something is reported, at most for a time."""
        if self._is_alive:
            wait([self._connection], timeout_s)

    def receive(self) -> None:
        """Take what has been reported, without waiting."""
        with self._lock:
            try:
                while self._is_alive and self._connection.poll():
                    said = self._connection.recv()
                    if isinstance(said, Begun):
                        self._pids[said.run] = said.pid
                    elif isinstance(said, Exited):
                        self._exits[said.run] = said
            except (EOFError, OSError):
                self._is_alive = False

    def pid_of(self, run: int) -> int | None:
        """Return the number of a run's process; None before it exists."""
        return self._pids.get(run)

    def exit_of(self, run: int) -> Exited | None:
        """Return how a run's process ended; None as long as it goes on."""
        return self._exits.get(run)

    def forget(self, run: int) -> None:
        """Drop what was reported of a run whose outcome is known."""
        self._pids.pop(run, None)
        self._exits.pop(run, None)

    def printed(self) -> str:
        """Return the end of what the server printed: why it ended, if it ended by itself."""
        if self._printed.closed:
            return self._last_printed
        size = self._printed.seek(0, os.SEEK_END)
        self._printed.seek(max(0, size - _SHOWN_BYTES))
        return self._printed.read().decode(errors="replace").strip()

    def close(self) -> None:
        """End the server, which kills its runs; what it has reported stays."""
        if self._printed.closed:
            return
        with self._lock:
            self._is_alive = False
            self._connection.close()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(_DEADLINE_S)
        self._process.kill()
        self._process.wait()
        self._last_printed = self.printed()
        self._printed.close()
