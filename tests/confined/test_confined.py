"""Readings in a process of their own: answers, errors, logs, and ends of every kind."""

import logging
import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from executive.confined import client
from executive.confined.allowance import Allowance
from executive.confined.client import read_confined
from executive.errors import ConfigError, DataError

HERE = "tests.confined.readers"


def test_arrays_come_back_as_they_were(file: Path) -> None:
    numbers, empty, flags = read_confined(f"{HERE}:arrays", file)
    assert np.array_equal(numbers, np.arange(12.0).reshape(3, 4))
    assert (empty.shape, empty.dtype) == ((0, 3), np.dtype("i8"))
    assert flags.tolist() == [True, False, True]
    numbers[0, 0] = 7.0  # its own memory, not a view of the file's


def test_relative_paths_count_from_the_present_folder(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(file.parent)
    assert len(read_confined(f"{HERE}:arrays", Path(file.name))) == 3


def test_errors_and_warnings_of_the_reader_arrive(
    file: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with pytest.raises(ConfigError, match=r"given\.bin: wrong setting"):
        read_confined(f"{HERE}:refuses", file)
    assert ("given", logging.WARNING, "3 of 4 left out") in caplog.record_tuples


def test_what_a_reader_raises_is_logged_with_its_line(
    file: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    with pytest.raises(DataError, match="ZeroDivisionError"):
        read_confined(f"{HERE}:raises", file)
    assert "return [np.array(1 // 0)]" in caplog.text


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            "raises",
            r"given\.bin: cannot be read \(ZeroDivisionError: .*\): damaged; copy or export",
        ),
        ("exits", r"given\.bin: reading it ended the process .*\(exit status 3: last words\)"),
        ("segfaults", r"given\.bin: reading it ended the process .*\(SIGSEGV"),
        ("asks_for_much", r"given\.bin: reading its 7 bytes asked for more than 200 MB of memory"),
        ("aborts_for_memory", r"given\.bin: reading its 7 bytes asked for more than 200 MB"),
    ],
)
def test_a_reader_that_dies_is_an_error_and_the_next_file_is_read(
    file: Path, name: str, words: str
) -> None:
    with pytest.raises(DataError, match=words):
        read_confined(f"{HERE}:{name}", file)
    assert len(read_confined(f"{HERE}:arrays", file)) == 3


def test_a_reader_that_does_not_end_is_stopped(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    allowance = Allowance(7, 200_000_000, 0.05, 60.0)
    monkeypatch.setattr(client.Allowance, "of", lambda path: allowance)
    with pytest.raises(DataError, match=r"given\.bin: reading its 7 bytes took more than 0\.1 s"):
        read_confined(f"{HERE}:computes_for_ever", file)


def test_a_reader_that_waits_is_given_up(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    allowance = Allowance(7, 200_000_000, 2.0, 0.2)
    monkeypatch.setattr(client.Allowance, "of", lambda path: allowance)
    with pytest.raises(DataError, match=r"given\.bin: not read within 0 s"):
        read_confined(f"{HERE}:waits_for_ever", file)
    monkeypatch.undo()
    assert len(read_confined(f"{HERE}:arrays", file)) == 3


def test_a_server_that_was_killed_is_replaced(file: Path) -> None:
    read_confined(f"{HERE}:arrays", file)
    (server,) = client._running
    os.kill(server._process.pid, signal.SIGKILL)
    deadline = time.monotonic() + 10.0
    while server.is_alive and time.monotonic() < deadline:
        time.sleep(0.01)
    assert len(read_confined(f"{HERE}:arrays", file)) == 3


def test_the_limits_follow_from_the_size(tmp_path: Path) -> None:
    path = tmp_path / "sparse"
    path.touch()
    os.truncate(path, 100_000_000)
    allowance = Allowance.of(path)
    assert allowance.memory_bytes == 400_000_000
    assert allowance.processor_s == pytest.approx(202.0)
    with pytest.raises(FileNotFoundError):
        read_confined(f"{HERE}:arrays", tmp_path / "none")
