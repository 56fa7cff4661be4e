"""A worker whose process is made up: what it does when that ends, is late, or cannot start."""

import pickle
from concurrent.futures import Future
from types import SimpleNamespace
from typing import Any

import pytest

from executive.mission.jobs.call import NotPortableError, WorkerDiedError
from executive.mission.jobs.worker import Worker
from executive.mission.jobs.worker_process import EndedError

PATIENCE_S = 30.0
SELECTIONS = {"motion": (SimpleNamespace(name="hermite"),)}


def answer(value: Any, *, is_error: bool = False) -> bytes:
    return pickle.dumps((is_error, value))


class Process:
    """Answers with what a script says; an exception in it is raised."""

    def __init__(self, *script: Any, start: BaseException | None = None) -> None:
        self.script, self.fails, self.is_killed, self.lives = list(script), start, False, True
        self.spent_s = lambda: 0.0

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
            "motion", SELECTIONS, "m545", 1, limits, lambda e: self.told.append((e.verb, e.reason))
        )
        left = iter(processes)
        self.worker._make = lambda: next(left)

    def asked(self, verb: str = "move") -> Future[Any]:
        task = SimpleNamespace(
            call=SimpleNamespace(verb=verb),
            plugin=object(),
            patience=lambda spent_s: None,
            address=SimpleNamespace(error=lambda kind, reason, *_: kind(reason)),
        )
        return self.worker.submit(task)


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
