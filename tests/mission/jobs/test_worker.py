"""A worker whose process is made up: what it does when that ends, is late, or cannot start."""

import pickle
import threading
from concurrent.futures import Future
from types import SimpleNamespace
from typing import Any

import pytest

from executive.machine.machine import load_machine
from executive.mission.jobs.call import NotPortableError, VerbOverdueError, WorkerDiedError
from executive.mission.jobs.worker import Worker
from executive.mission.jobs.worker_process import EndedError

MACHINE = load_machine("m545")

PATIENCE_S = 30.0
SELECTIONS = {"motion": (SimpleNamespace(name="hermite"),)}


def answer(value: Any, *, is_error: bool = False) -> bytes:
    return pickle.dumps((is_error, value))


class Process:
    """Answers with what a script says; an exception in it is raised."""

    def __init__(self, *script: Any, start: BaseException | None = None) -> None:
        self.script, self.fails, self.is_killed, self.lives = list(script), start, False, True
        self.spent_s = self.ready_s = lambda: 0.0

    def start(self) -> None:
        if self.fails is not None:
            raise self.fails

    def is_alive(self) -> bool:
        return self.lives

    def ask(self, request: bytes, patience: Any) -> bytes:
        told = self.script.pop(0)
        if isinstance(told, BaseException):
            raise told
        return told

    def kill(self) -> None:
        self.is_killed = True

    def close(self, deadline_s: float) -> None:
        self.lives = False


class Stand:
    """A worker over processes that are given in order, and what it tells."""

    def __init__(self, *processes: Process) -> None:
        self.told: list[tuple[str, str]] = []
        limits = SimpleNamespace(start_s=5.0)
        self.worker = Worker(
            "motion", SELECTIONS, MACHINE, 1, limits, lambda e: self.told.append((e.verb, e.reason))
        )
        left = iter(processes)
        self.worker._make = lambda: next(left)

    def asked(self, verb: str = "move") -> Future[Any]:
        return self.worker.submit(task_of(verb))


def task_of(verb: str = "move", patience: Any = lambda spent_s, ready_s: None) -> Any:
    return SimpleNamespace(
        call=SimpleNamespace(verb=verb),
        plugin=object(),
        patience=patience,
        address=SimpleNamespace(error=lambda kind, reason, *_: kind(reason)),
    )


@pytest.fixture(autouse=True)
def portable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("executive.mission.jobs.worker.dumped", lambda call: b"")
    monkeypatch.setattr("executive.mission.jobs.worker.place_in_dump", lambda dump, plugin: None)


def ended(reason: str = "it exited with status 1") -> EndedError:
    return EndedError(reason, "")


def test_calls_are_answered_by_one_process_in_order() -> None:
    process = Process(answer(1), answer(2))
    stand = Stand(process)
    assert stand.worker.prepare().result(PATIENCE_S) is process
    assert [stand.asked().result(PATIENCE_S) for _ in range(2)] == [1, 2]
    assert stand.told == []
    stand.worker.close()
    assert not process.lives


def test_what_a_verb_raises_is_raised_and_the_process_stays() -> None:
    stand = Stand(Process(answer(KeyError("x"), is_error=True), answer(2)))
    with pytest.raises(KeyError):
        stand.asked().result(PATIENCE_S)
    assert stand.asked().result(PATIENCE_S) == 2
    assert stand.told == []


def test_a_process_that_ends_is_replaced_and_its_call_tried_once_more() -> None:
    first = Process(ended("it ended"))
    stand = Stand(first, Process(answer(3)))
    assert stand.asked("reach").result(PATIENCE_S) == 3
    assert first.is_killed
    assert stand.told == [("reach", "it ended")]


def test_a_call_that_ends_two_processes_fails() -> None:
    second = Process(ended("again"))
    stand = Stand(Process(ended()), second, Process(answer(4)))
    with pytest.raises(WorkerDiedError, match="again"):
        stand.asked().result(PATIENCE_S)
    assert second.is_killed
    assert len(stand.told) == 1
    assert stand.asked().result(PATIENCE_S) == 4  # the next call has a new process


def test_a_process_that_ended_between_two_calls_is_replaced_and_told() -> None:
    first = Process(answer(1))
    stand = Stand(first, Process(answer(2)))
    assert stand.asked().result(PATIENCE_S) == 1
    first.lives = False
    assert stand.asked().result(PATIENCE_S) == 2
    assert first.is_killed
    assert stand.told == [("", "it ended between two calls")]


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (EndedError("no memory", ""), "did not start: no memory"),
        (TimeoutError(), "did not start: not ready within 5 s"),
        (OSError("no room"), "did not start: no room"),
    ],
)
def test_a_process_that_does_not_start_is_told_with_its_reason(error, told) -> None:
    process = Process(start=error)
    stand = Stand(process, Process(start=error))
    with pytest.raises(WorkerDiedError, match=f"motion plugin 'hermite' {told}"):
        stand.worker.prepare().result(PATIENCE_S)
    assert process.is_killed


def test_what_a_plugin_raises_at_its_start_is_raised() -> None:
    process = Process(start=ValueError("no such mesh"))
    stand = Stand(process)
    with pytest.raises(ValueError, match="no such mesh"):
        stand.worker.prepare().result(PATIENCE_S)
    assert process.is_killed


def test_an_answer_that_cannot_be_read_is_told() -> None:
    stand = Stand(Process(b"torn"))
    with pytest.raises(NotPortableError, match="its answer cannot be read: "):
        stand.asked().result(PATIENCE_S)


def test_an_answer_that_is_late_twice_is_told_with_what_the_process_did() -> None:
    late = [Process(TimeoutError()), Process(TimeoutError())]
    for process in late:
        process.stopped, process.dump = lambda: "", lambda: "its stack"
    late[1].stopped = lambda: "it was stopped by a signal"
    stand = Stand(*late)
    found: list[tuple[str, object, str]] = []

    def overdue(reason: str, place: object, dump: str) -> VerbOverdueError:
        found.append((reason, place, dump))
        return VerbOverdueError(reason)

    task = task_of(
        patience=lambda spent_s, ready_s: SimpleNamespace(told=lambda: "no answer in 2 s")
    )
    task.overdue = overdue
    with pytest.raises(VerbOverdueError, match="stopped by a signal"):
        stand.worker.submit(task).result(PATIENCE_S)
    assert found == [
        ("no answer in 2 s", None, "its stack"),
        ("it was stopped by a signal", None, "its stack"),
    ]
    assert stand.told == [("move", "no answer in 2 s")]
    assert [one.is_killed for one in late] == [True, True]


def test_a_process_without_memory_is_replaced_and_told_by_the_name_of_the_error() -> None:
    stand = Stand(Process(answer(MemoryError("1 GB"), is_error=True)), Process(answer(3)))
    assert stand.asked().result(PATIENCE_S) == 3
    assert stand.told == [("move", "MemoryError")]


class Busy(Process):
    """Computes until it is interrupted, as a process that is killed ends."""

    def __init__(self) -> None:
        super().__init__()
        self.asked, self.interrupted = threading.Event(), threading.Event()

    def ask(self, request: bytes, patience: Any) -> bytes:
        self.asked.set()
        assert self.interrupted.wait(PATIENCE_S)
        raise ended("it was killed")

    def interrupt(self) -> None:
        self.interrupted.set()


def test_a_call_that_is_dropped_ends_its_process_and_is_not_tried_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun: list[tuple[float, bool]] = []

    class Timer:
        daemon = False

        def __init__(self, after_s: float, do: Any, given: list[Any]) -> None:
            self.after_s, self.do, self.given = after_s, do, given

        def start(self) -> None:
            begun.append((self.after_s, self.daemon))
            self.do(*self.given)

    monkeypatch.setattr("executive.mission.jobs.worker.threading.Timer", Timer)
    busy = Busy()
    stand = Stand(busy, Process(answer(5)))
    dropped = stand.asked()
    assert busy.asked.wait(PATIENCE_S)
    waiting = stand.asked()
    stand.worker.abandon(waiting)  # its turn has not come: the call before it goes on
    assert not busy.interrupted.is_set()
    stand.worker.abandon(dropped)
    with pytest.raises(WorkerDiedError, match="it was killed"):
        dropped.result(PATIENCE_S)
    assert begun == [(2.0, True), (2.0, True)]
    assert busy.is_killed
    assert stand.told == []
    assert waiting.result(PATIENCE_S) == 5


def test_a_worker_that_is_busy_when_it_is_closed_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("executive.mission.jobs.worker._DEADLINE_S", 0.01)
    busy = Busy()
    stand = Stand(busy)
    asked = stand.asked()
    assert busy.asked.wait(PATIENCE_S)
    stand.worker._thread.join = lambda timeout, join=stand.worker._thread.join: join(
        PATIENCE_S if busy.interrupted.is_set() else timeout
    )
    stand.worker._make = lambda: Process(answer(0))
    stand.worker.close()
    assert busy.interrupted.is_set()
    assert not stand.worker._thread.is_alive()
    assert asked.done()
