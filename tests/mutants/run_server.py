"""Asks a process for runs of pytest, each with a limit of time."""

import json
import os
import select
import signal
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from mutants.forks import PIPES

OUTPUT = 4000  # characters of the end that are kept


class RunServer:
    """Starts a process that serves runs as forks of itself.

    Args:
        words: That start it.
        root: Folder in which it runs.
        environment: Of it and of all runs.
    """

    def __init__(self, words: Sequence[str], root: Path, environment: Mapping[str, str]) -> None:
        asked, asks = os.pipe()
        answers, answered = os.pipe()
        self._process = subprocess.Popen(
            words,
            cwd=root,
            env={**environment, PIPES: f"{asked} {answered}"},
            pass_fds=(asked, answered),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        os.close(asked)
        os.close(answered)
        self._asks = os.fdopen(asks, "wb", buffering=0)
        self._answers = os.fdopen(answers, "rb", buffering=0)  # what is not read yet is selected
        self._running: int | None = None
        self._is_ready = False

    def wait(self) -> None:
        """Return once it has imported what it does not import anew for each run.

        Raises:
            ConnectionError: If it has ended.
        """
        if not self._is_ready:
            self._answer()
        self._is_ready = True

    def run(self, asked: Mapping[str, Any], limit_s: float) -> tuple[int | None, str]:
        """Run pytest; return its status, None if it ran out of time, and the end of its output.

        Raises:
            ConnectionError: If the server has ended.
        """
        self.wait()
        with tempfile.NamedTemporaryFile() as output:
            self._asks.write(f"{json.dumps({**asked, 'output': output.name})}\n".encode())
            self._running = int(self._answer())
            is_ended = bool(select.select([self._answers], [], [], limit_s)[0])
            self._end()
            status = int(self._answer())
            text = output.read().decode(errors="replace")
        return status if is_ended else None, text[-OUTPUT:]

    def _answer(self) -> bytes:
        line = self._answers.readline()
        if not line:
            raise ConnectionResetError("the server of runs has ended")
        return line

    def _end(self) -> None:
        """End the run with all the processes that its tests started."""
        if self._running is not None:
            with suppress(ProcessLookupError):
                os.killpg(self._running, signal.SIGKILL)
        self._running = None

    def close(self) -> None:
        """End a run that has not ended, and the server."""
        self._end()
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self._asks.close()
        self._answers.close()
