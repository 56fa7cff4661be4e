"""A run under a supervisor, in this process: what it notes, and what it leaves."""

import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from executive.supervision import beacon, child, early_stop
from executive.supervision.beacon import Beacon
from executive.supervision.early_stop import STOPPING, TOLD, end_at_signals


@pytest.fixture
def system(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Any]]:
    """What the system is asked for; nothing of it is done."""
    asked: list[Any] = []
    opened: list[Any] = []

    def enable(file: Any) -> None:
        opened.append(file)
        asked.append(file.name)

    library = SimpleNamespace(prctl=lambda *given: asked.append(given))
    monkeypatch.setattr(child.ctypes, "CDLL", lambda name: library)
    monkeypatch.setattr(signal, "signal", lambda *given: asked.append(given))
    monkeypatch.setattr(child.faulthandler, "enable", enable)
    monkeypatch.setattr(
        child.faulthandler,
        "register",
        lambda number, file, all_threads: asked.append((number, file.name, all_threads)),
    )
    monkeypatch.setattr(beacon, "_inherited", [])
    yield asked
    for file in opened:  # open as long as a process; this one goes on
        file.close()


@pytest.mark.parametrize("status", [0, 3])
def test_the_status_is_noted_and_the_stack_s_file_is_removed(
    system: list[Any], status: int
) -> None:
    page, there = Beacon(), []

    def run() -> int:
        assert beacon.beacon() is page
        there.append(Path(page.text("stack")))
        assert there[0].is_file()
        return status

    with pytest.raises(SystemExit) as ended:
        child.live(page, run)
    assert ended.value.code == page.status() == status
    (stack,) = there
    assert stack.name.startswith("executive-")
    assert stack.suffix == ".stack"
    assert not stack.exists()
    assert system == [
        str(stack),
        (signal.SIGUSR2, str(stack), False),
        (1, signal.SIGRTMIN),  # prctl(2): PR_SET_PDEATHSIG
        *((number, signal.SIG_IGN) for number in STOPPING),
    ]


def test_an_error_is_told_with_its_traceback_and_is_status_1(
    system: list[Any], capsys: pytest.CaptureFixture[str]
) -> None:
    def run() -> int:
        raise KeyError("lost")

    page = Beacon()
    with pytest.raises(SystemExit) as ended:
        child.live(page, run)
    assert (ended.value.code, page.status()) == (1, 1)
    assert "KeyError: 'lost'" in capsys.readouterr().err


def test_a_signal_while_the_program_loads_is_told_and_ends_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    handlers: dict[int, Any] = {}
    done: list[Any] = []
    monkeypatch.setattr(signal, "signal", handlers.__setitem__)
    monkeypatch.setattr(early_stop.os, "write", lambda *given: done.append(given))
    monkeypatch.setattr(early_stop.os, "_exit", lambda status: done.append(("exit", status)))
    end_at_signals(lambda status: done.append(("finish", status)))
    assert list(handlers) == list(STOPPING)
    for handler in handlers.values():
        done.clear()
        handler(15, None)
        assert done == [(2, f"{TOLD}\n".encode()), ("finish", 1), ("exit", 1)]

    def closed(*_: Any) -> None:
        raise OSError

    monkeypatch.setattr(early_stop.os, "write", closed)
    done.clear()
    handlers[signal.SIGHUP](1, None)
    assert done == [("finish", 1), ("exit", 1)]
    assert sys.exc_info() == (None, None, None)
