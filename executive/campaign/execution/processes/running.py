"""A run in a process of its own, held to its limits."""

import signal
import socket
from pathlib import Path

from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.pool import Lost, RefusedError
from executive.campaign.execution.processes.fork_client import ForkClient
from executive.campaign.execution.processes.fork_protocol import Ended, Exited
from executive.campaign.execution.processes.isolated_run import OUTPUT
from executive.campaign.execution.processes.process_tree import ProcessTree
from executive.campaign.execution.run_answer import RunAnswer, read_answer
from executive.campaign.trial import Outcome, Status, Trial
from executive.clock import wall_s

_LOOK_EVERY_S = 0.2  # at memory: a look takes some milliseconds
_PREPARING_S = 600.0  # for imports before the first run
_LONGEST_REASON = 2000
_SIGNALS = {
    signal.SIGSEGV: "segmentation fault",
    signal.SIGABRT: "abort",
    signal.SIGBUS: "bus error",
    signal.SIGFPE: "arithmetic error",
    signal.SIGILL: "illegal instruction",
}


class Running:
    """A run that goes on in a process of its own."""

    def __init__(self, server: ForkClient, run: int, trial: Trial, folder: Path) -> None:
        self._server = server
        self._run = run
        self._trial = trial
        self._folder = folder
        self._asked_s = wall_s()
        self._begun_s: float | None = None
        self._looked_s = self._asked_s
        self._processes: ProcessTree | None = None
        self._worker = socket.gethostname()
        self._peak_bytes = 0
        self._exceeded: tuple[Status, str] | None = None
        self._result: Outcome | Lost | None = None

    def poll(self) -> Outcome | Lost | None:
        """Return what came of the run, None as long as it goes on; end it beyond its limits.

        It has to be called several times a second, because the limits are held here. The number of
        tries in the outcome is 1.

        Raises:
            RefusedError: If the work refuses its arguments.
            DiskFullError: If no space is left for the run's files.
        """
        if self._result is not None:
            return self._result
        self._server.receive()
        self._see_begin()
        exited = self._server.exit_of(self._run)
        if exited is not None:
            self._kill_all()
            self._server.forget(self._run)
            self._result = self._outcome(exited)
        elif not self._server.is_alive:
            self._kill_all()
            self._result = self._lost()
        else:
            self._hold_limits()
        return self._result

    @property
    def has_ended(self) -> bool:
        """Whether `poll` has returned what came of it."""
        return self._result is not None

    def kill(self) -> None:
        """End the run with all its processes, at once; `poll` then returns what came of it."""
        self._server.receive()
        self._see_begin()
        if self._result is None:
            self._kill_all()

    def _see_begin(self) -> None:
        pid = self._server.pid_of(self._run)
        if self._processes is None and pid is not None:
            self._begun_s = wall_s()
            self._processes = ProcessTree(pid)
            self._worker = f"{self._worker}:{pid}"

    def _kill_all(self) -> None:
        if self._processes is not None:
            self._processes.kill()

    def _hold_limits(self) -> None:
        now_s, limits = wall_s(), self._trial.limits
        if self._processes is None or self._begun_s is None:
            if now_s - self._asked_s > _PREPARING_S:
                self._server.close()  # its imports hang
            return
        if now_s - self._begun_s > limits.time_s:
            self._exceed(Status.TIMED_OUT, f"ended after the limit of {limits.time_s:g} s")
        elif now_s - self._looked_s > _LOOK_EVERY_S:
            self._looked_s = now_s
            used = self._processes.resident_bytes()
            self._peak_bytes = max(self._peak_bytes, used)
            if used > limits.memory_bytes:
                said = f"{_mebibytes(used)}, beyond the limit of {_mebibytes(limits.memory_bytes)}"
                self._exceed(Status.OUT_OF_MEMORY, f"its processes held {said}")

    def _exceed(self, status: Status, reason: str) -> None:
        self._exceeded = self._exceeded or (status, reason)
        self._kill_all()

    def _outcome(self, exited: Exited) -> Outcome:
        word = exited.last_word
        if word is not None and word.ended is Ended.REFUSED:
            raise RefusedError(self._trial.number, word.reason)
        if word is not None and word.ended is Ended.DISK_FULL:
            raise DiskFullError(word.reason)
        answer = read_answer(self._folder, self._trial)
        if answer is not None:
            return self._done(answer, exited)
        status, reason = self._exceeded or self._failure(exited)
        return Outcome(
            self._trial.number,
            status,
            reason=reason,
            wall_s=wall_s() - self._asked_s,
            cpu_s=exited.cpu_s,
            peak_memory_bytes=max(self._peak_bytes, exited.peak_memory_bytes),
            worker=self._worker,
        )

    def _done(self, answer: RunAnswer, exited: Exited) -> Outcome:
        return Outcome(
            self._trial.number,
            Status.DONE,
            answer=answer.answer,
            wall_s=wall_s() - self._asked_s,
            cpu_s=exited.cpu_s,
            peak_memory_bytes=max(self._peak_bytes, exited.peak_memory_bytes),
            worker=self._worker,
        )

    def _failure(self, exited: Exited) -> tuple[Status, str]:
        if exited.last_word is not None:
            return Status.CRASHED, exited.last_word.reason
        if exited.exit_code == -signal.SIGKILL:
            held = f"its processes held {_mebibytes(self._peak_bytes)} at the last look"
            return Status.KILLED, f"signal SIGKILL, by a person or by the system; {held}"
        if exited.exit_code < 0:
            number = signal.Signals(-exited.exit_code)
            said = f"signal {number.name} ({_SIGNALS.get(number, number.name)})"
        else:
            said = f"it ended by exit status {exited.exit_code} without an answer"
        return Status.CRASHED, f"{said}{self._last_lines()}"[:_LONGEST_REASON]

    def _last_lines(self) -> str:
        """Return where Python was, from the dump of the fault handler, else what was printed."""
        try:
            lines = (self._folder / OUTPUT).read_text(errors="replace").splitlines()
        except OSError:
            return ""
        dump = [i for i, line in enumerate(lines) if line.startswith("Fatal Python error")]
        shown = lines[dump[-1] :][:8] if dump else lines[-4:]
        return "".join(f"\n{line}" for line in shown if line.strip())

    def _lost(self) -> Outcome | Lost:
        """Return what is known when the server has ended: perhaps the answer was complete."""
        answer = read_answer(self._folder, self._trial)
        if answer is not None:
            return answer.outcome(self._trial.number)
        printed = self._server.printed()
        return Lost(
            self._trial.number,
            f"the process that begins runs has ended{': ' if printed else ''}{printed}",
        )


def _mebibytes(size: int) -> str:
    return f"{size / 2**20:.0f} MiB"
