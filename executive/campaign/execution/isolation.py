"""Begins runs, each in a process of its own that is forked after the imports.

A process that is forked from one which has imported the libraries begins within milliseconds;
importing them anew takes seconds, more than many a run.
"""

from collections.abc import Mapping
from pathlib import Path
from threading import RLock

from executive.campaign.execution.processes.fork_client import ForkClient
from executive.campaign.execution.processes.fork_protocol import Begin
from executive.campaign.execution.processes.running import Running
from executive.campaign.trial import Trial


class Isolation:
    """Begins runs on this computer; several threads may use it."""

    def __init__(self) -> None:
        self._lock = RLock()
        self._server: ForkClient | None = None
        self._count = 0
        self._running: list[Running] = []

    def begin(self, trial: Trial, folder: Path, inputs: Mapping[str, Path]) -> Running:
        """Begin a run.

        Args:
            trial: What to run.
            folder: An existing empty folder for its files.
            inputs: Local path of each input by its name.

        Raises:
            OSError: If no process can be started.
        """
        with self._lock:
            if self._server is not None and not self._server.is_alive:
                self._server.close()
                self._server = None
            self._server = self._server or ForkClient()
            self._count += 1
            running = Running(self._server, self._count, trial, folder)
            self._server.begin(Begin(self._count, trial, folder.resolve(), dict(inputs)))
            self._running = [one for one in self._running if not one.has_ended] + [running]
            return running

    def wait(self, timeout_s: float) -> None:
        """Wait until something is reported of any run, at most for a time [s]."""
        if self._server is not None:
            self._server.wait(timeout_s)

    def close(self) -> None:
        """Kill every run that still goes on."""
        with self._lock:
            for running in self._running:
                running.kill()
            self._running = []
            if self._server is not None:
                self._server.close()
                self._server = None
