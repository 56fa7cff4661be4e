"""The mission's end of a worker process that is made up: what it sends, awaits and releases."""

import os
import pickle
import signal
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import psutil
import pytest

from executive.machine.machine import load_machine
from executive.mission.jobs import worker_process
from executive.mission.jobs.serving import serve
from executive.mission.jobs.worker_process import EndedError, WorkerProcess

MACHINE = load_machine("m545")


class Connection:
    """Answers what a test says, after a number of looks."""

    def __init__(self, *answers: Any) -> None:
        self.answers = list(answers)
        self.sent: list[bytes] = []
        self.waits: list[float] = []
        self.is_closed = False

    def send_bytes(self, data: bytes) -> None:
        if self.answers and isinstance(self.answers[0], BrokenPipeError):
            raise self.answers[0]
        self.sent.append(data)

    def poll(self, wait_s: float) -> bool:
        self.waits.append(wait_s)
        if self.answers and self.answers[0] == "later":
            self.answers.pop(0)
            return False
        return bool(self.answers)

    def recv_bytes(self) -> bytes:
        answer = self.answers.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer

    def close(self) -> None:
        self.is_closed = True


class Process:
    """A process that lives until it is killed."""

    pid = os.getpid()

    def __init__(self, exitcode: int | None = None) -> None:
        self.exitcode = exitcode
        self.calls: list[Any] = []

    def start(self) -> None:
        self.calls.append("start")

    def kill(self) -> None:
        self.calls.append("kill")

    def join(self, limit_s: float) -> None:
        self.calls.append(("join", limit_s))

    def is_alive(self) -> bool:
        return "kill" not in self.calls


class Patience:
    """Waits a second, and as often again as it is told."""

    def __init__(self, *more_s: float) -> None:
        self.limit_s, self.left = 1.0, list(more_s)

    def more_s(self) -> float:
        return self.left.pop(0) if self.left else 0.0


def worker(connection: Connection | None = None, process: Process | None = None) -> WorkerProcess:
    made = WorkerProcess("motion", {}, MACHINE, 7, SimpleNamespace(memory_bytes=10, start_s=5.0))
    made._connection, made._process = connection, process
    return made


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(worker_process.tempfile, "tempdir", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize("error", [None, ValueError("no mesh")])
def test_it_starts_a_process_that_serves_and_waits_for_its_word(
    error: Exception | None, monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    ours, theirs, process = Connection(pickle.dumps(error)), Connection(), Process()
    made: list[Any] = []

    def of(target: Any, args: Any, daemon: bool) -> Process:
        made.append((target, args, daemon))
        return process

    context = SimpleNamespace(Pipe=lambda: (ours, theirs), Process=of)
    monkeypatch.setattr(worker_process.mp, "get_context", {"forkserver": context}.__getitem__)
    one = worker()
    if error is None:
        one.start()
        assert one.is_alive()
    else:
        with pytest.raises(ValueError, match="no mesh"):
            one.start()
    (stack,) = folder.glob("executive-worker-*.stack")
    assert made == [(serve, (theirs, "motion", {}, MACHINE, 7, 10, stack), True)]
    assert (process.calls, theirs.is_closed, ours.is_closed) == (["start"], True, False)
    assert ours.waits == [5.0]


def test_a_process_that_was_not_started_is_told() -> None:
    one = worker()
    assert not one.is_alive()
    with pytest.raises(EndedError, match="the process was not started"):
        one.ask(b"", Patience())
    one.interrupt()
    one.close(1.0)


def test_an_answer_is_awaited_as_long_as_patience_goes_on() -> None:
    connection = Connection("later", "later", b"answer")
    assert worker(connection, Process()).ask(b"request", Patience(0.5, 0.25)) == b"answer"
    assert connection.sent == [b"request"]
    assert connection.waits == [1.0, 0.5, 0.25]
    with pytest.raises(TimeoutError):
        worker(Connection("later", b"answer"), Process()).ask(b"", Patience())


@pytest.mark.parametrize(
    ("exitcode", "told"),
    [
        (None, "its worker process closed its connection"),
        (-signal.SIGSEGV, "its worker process was ended by SIGSEGV"),
        (3, "its worker process ended with exit status 3"),
        (0, "its worker process ended with exit status 0"),
    ],
)
@pytest.mark.parametrize("error", [BrokenPipeError(), EOFError(), ConnectionResetError()])
def test_a_process_that_ends_is_told_with_how_and_its_stack(
    error: Exception, exitcode: int | None, told: str, folder: Path
) -> None:
    process = Process(exitcode)
    one = worker(Connection(error), process)
    (stack,) = folder.glob("*.stack")
    stack.write_text("Fatal Python error")
    with pytest.raises(EndedError, match=f"^{told}$") as raised:
        one.ask(b"", Patience())
    assert raised.value.dump == "Fatal Python error"
    assert process.calls == [("join", 2.0)]
    stack.unlink()
    one._connection = Connection(error)
    with pytest.raises(EndedError) as raised:
        one.ask(b"", Patience())
    assert raised.value.dump == ""


def test_processor_time_is_that_of_user_and_system(monkeypatch: pytest.MonkeyPatch) -> None:
    times = SimpleNamespace(user=1.5, system=0.25)
    monkeypatch.setattr(
        worker_process.psutil, "Process", lambda pid: SimpleNamespace(cpu_times=lambda: times)
    )
    one = worker(None, Process())
    assert one.spent_s() == 1.75

    def gone(pid: int) -> None:
        raise psutil.NoSuchProcess(pid)

    monkeypatch.setattr(worker_process.psutil, "Process", gone)
    assert one.spent_s() == 1.75  # the last one that was seen
    monkeypatch.setattr(worker_process, "ready_s", lambda process: 0.5 * process)
    assert one.ready_s() == 0.5 * one._process.pid
    assert one.stopped() == ""


@pytest.mark.parametrize("status", [psutil.STATUS_STOPPED, psutil.STATUS_RUNNING])
def test_a_process_that_a_signal_stopped_is_told(
    status: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = SimpleNamespace(pid=4711, status=lambda: status)
    monkeypatch.setattr(worker_process.psutil, "Process", lambda pid: found)
    told = worker(None, Process()).stopped()
    if status == psutil.STATUS_STOPPED:
        assert told.startswith("no answer: its worker process 4711 was stopped by a signal")
    else:
        assert told == ""


def test_the_stack_of_a_process_that_hangs_is_awaited(
    monkeypatch: pytest.MonkeyPatch, folder: Path
) -> None:
    one = worker(None, Process())
    (stack,) = folder.glob("*.stack")
    asked: list[Any] = []

    def kill(pid: int, number: int) -> None:
        asked.append((pid, number))
        stack.write_text("Thread 1")

    monkeypatch.setattr(worker_process.os, "kill", kill)
    assert one.dump() == "Thread 1"
    assert asked == [(Process.pid, signal.SIGUSR1)]


def test_a_stack_that_never_comes_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter((0.0, 0.1, 0.15, 0.21, 0.3))
    monkeypatch.setattr(worker_process, "wall_s", lambda: next(clock))
    monkeypatch.setattr(worker_process, "_WAKE_S", 0.0)
    monkeypatch.setattr(worker_process.os, "kill", lambda *_: None)
    assert worker(None, Process()).dump() == ""
    assert list(clock) == [0.3]


def test_what_it_held_is_released(folder: Path) -> None:
    connection, process = Connection(), Process()
    one = worker(connection, process)
    one.interrupt()
    assert (process.calls, connection.is_closed) == (["kill"], False)
    one.kill()
    assert process.calls == ["kill", "kill", ("join", 2.0)]
    assert connection.is_closed
    assert list(folder.glob("*.stack")) == []
    one.kill()  # a second time


def test_closing_lets_a_process_end_by_itself_first() -> None:
    connection, process = Connection(), Process()
    worker(connection, process).close(1.5)
    assert process.calls == [("join", 1.5), "kill", ("join", 2.0)]
    assert connection.is_closed
