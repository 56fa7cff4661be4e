"""The program: which verbs have a supervisor, and what its exit status is."""

import os
import sys
from typing import Any

import pytest

from executive.commands import entry


@pytest.fixture
def done(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What the program does, in order."""
    found: list[Any] = []
    monkeypatch.setattr(entry, "end_at_signals", lambda: found.append("signals"))
    monkeypatch.setattr(entry, "_open_standard_files", lambda: found.append("files"))
    monkeypatch.setattr(entry, "take_defaults", lambda: found.append("defaults"))

    def supervised(run: Any, say: Any) -> int:
        found.append("supervised")
        say("a word")
        return int(run())

    monkeypatch.setattr("executive.supervision.supervisor.supervised", supervised)
    return found


def ends(monkeypatch: pytest.MonkeyPatch, error: BaseException | None) -> None:
    def command_line() -> None:
        if error is not None:
            raise error

    monkeypatch.setattr("executive.commands.main.main", command_line)


@pytest.mark.parametrize(
    ("words", "is_supervised"),
    [
        (["run", "relocate"], True),
        (["resume", "runs/1"], True),
        (["run", "relocate", "--dry"], False),
        (["run", "--help"], False),
        (["check", "run"], False),
        ([], False),
    ],
)
def test_a_verb_that_moves_a_machine_is_supervised(
    done: list[Any], monkeypatch: pytest.MonkeyPatch, capsys: Any, words: list[str],
    is_supervised: bool,
) -> None:  # fmt: skip
    monkeypatch.setattr(sys, "argv", ["executive", *words])
    ends(monkeypatch, SystemExit(3))
    with pytest.raises(SystemExit) as ended:
        entry.main()
    assert ended.value.code == 3
    assert done == ["signals", "files", "supervised" if is_supervised else "defaults"]
    assert capsys.readouterr().err == ("a word\n" if is_supervised else "")


@pytest.mark.parametrize(
    ("words", "before", "after"),
    [
        (["run", "relocate"], None, "1"),
        (["run", "relocate"], "4", "4"),  # who asks for more gets them
        (["check", "relocate"], None, None),
    ],
)
def test_a_mission_computes_on_one_thread_unless_it_is_told_otherwise(
    done: list[Any], monkeypatch: pytest.MonkeyPatch, words: list[str],
    before: str | None, after: str | None,
) -> None:  # fmt: skip
    environment = {} if before is None else {"OMP_NUM_THREADS": before}
    monkeypatch.setattr(os, "environ", environment)
    monkeypatch.setattr(sys, "argv", ["executive", *words])
    ends(monkeypatch, None)
    with pytest.raises(SystemExit):
        entry.main()
    assert os.environ.get("OMP_NUM_THREADS") == after


@pytest.mark.parametrize(
    ("error", "status", "told"),
    [
        (None, 0, ""),
        (SystemExit(), 0, ""),
        (SystemExit(0), 0, ""),
        (SystemExit(4), 4, ""),
        (SystemExit("no such verb"), 1, "no such verb\n"),
        (KeyboardInterrupt(), 1, "stopped\n"),
    ],
)
def test_the_exit_status_is_that_of_the_command_line(
    done: list[Any], monkeypatch: pytest.MonkeyPatch, capsys: Any, error: Any, status: int,
    told: str,
) -> None:  # fmt: skip
    ends(monkeypatch, error)
    assert entry._status_of_a_tool() == status
    assert capsys.readouterr().err == told


def test_a_standard_file_that_is_closed_leads_nowhere(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[Any] = []
    there = os.fstat

    def look(number: int) -> Any:
        if number in (0, 2):
            raise OSError
        return there(number)

    monkeypatch.setattr(entry.os, "fstat", look)
    monkeypatch.setattr(entry.os, "open", lambda *given: opened.append(given) or 77)
    monkeypatch.setattr(entry.os, "fdopen", lambda *given, encoding: (*given, encoding))
    for name in ("stdin", "stdout", "stderr"):
        monkeypatch.setattr(sys, name, "before")
    entry._open_standard_files()
    found = sys.stdin, sys.stdout, sys.stderr
    monkeypatch.undo()
    assert found == ((77, "r", "utf-8"), "before", (77, "w", "utf-8"))
    assert opened == [(os.devnull, os.O_RDWR)] * 2
