"""What the process of a run leaves: its answer, or its last word about an error."""

import errno
import socket
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from executive.campaign.execution.processes import isolated_run
from executive.campaign.execution.processes.fork_protocol import Begin, Ended, LastWord
from executive.campaign.execution.run_answer import fingerprint, read_answer
from executive.campaign.trial import Limits, Trial
from executive.config import NoSettings
from executive.errors import ConfigError, DataError
from executive.interfaces.work import Piece

TRIAL = Trial(3, "made_up", {"a": 1}, 42, {}, Limits(10.0, 10**9))


@pytest.fixture
def worked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return what does a run with a function in the place of the work."""

    def run(does: Any) -> LastWord:
        made = SimpleNamespace(run=does), NoSettings()
        monkeypatch.setattr(isolated_run, "work_of", lambda trial: made)
        return isolated_run._worked(Begin(0, TRIAL, tmp_path, {"machine": tmp_path}))

    return run


def test_the_answer_is_in_the_folder_with_what_it_took(worked, tmp_path, monkeypatch) -> None:
    def usage(who: int) -> SimpleNamespace:
        own = who == isolated_run.resource.RUSAGE_SELF
        return SimpleNamespace(
            ru_utime=1.0 if own else 0.25, ru_stime=0.5 if own else 0.125, ru_maxrss=2000
        )

    clock = iter((100.0, 107.5))
    monkeypatch.setattr(isolated_run.resource, "getrusage", usage)
    monkeypatch.setattr(isolated_run, "wall_s", lambda: next(clock))
    pieces = []
    assert worked(lambda piece: pieces.append(piece) or {"b": 2}) == LastWord(Ended.ANSWERED)
    assert pieces == [Piece(NoSettings(), 42, tmp_path, {"machine": tmp_path})]
    answer = read_answer(tmp_path, TRIAL)
    assert answer.trial == fingerprint(TRIAL)
    assert answer.answer == {"b": 2}
    assert answer.wall_s == 7.5
    assert answer.cpu_s == 1.875
    assert answer.peak_memory_bytes == 2000 * 1024
    assert answer.worker.startswith(f"{socket.gethostname()}:")


@pytest.mark.parametrize(
    ("error", "ended", "reason"),
    [
        (ConfigError("no such plugin"), Ended.REFUSED, "no such plugin"),
        (DataError("torn"), Ended.RAISED, "DataError: torn ("),
        (KeyError("x"), Ended.RAISED, "KeyError: 'x' ("),
        (SystemExit(2), Ended.RAISED, "SystemExit: 2 ("),
        (ConfigError("x" * 5000), Ended.REFUSED, "x" * 2000),
        (OSError(errno.ENOSPC, "full"), Ended.DISK_FULL, "no space is left for "),
    ],
)
def test_an_error_is_the_last_word_with_its_place(worked, capsys, error, ended, reason) -> None:
    def fails(piece: Piece) -> None:
        raise error

    told = worked(fails)
    assert told.ended is ended
    assert told.reason.startswith(reason)
    if ended is Ended.RAISED:
        line = fails.__code__.co_firstlineno + 1
        assert told.reason == f"{reason}{__file__}:{line})"
    else:
        assert len(told.reason) <= max(len(reason), 300)
    assert type(error).__name__ in capsys.readouterr().err


def test_a_full_disk_is_told_whatever_the_error_says(worked, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(isolated_run, "is_space_left", lambda folder: False)

    def fails(piece: Piece) -> None:
        raise RuntimeError("cannot write")

    assert worked(fails) == LastWord(Ended.DISK_FULL, f"no space is left for {tmp_path}")
