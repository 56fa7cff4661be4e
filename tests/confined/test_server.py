"""The server of confined readings, in this process: what it answers, and what a child may take."""

import json
import logging
import mmap
import os
import resource
import signal
import socket
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from executive.confined import server
from executive.confined.client import _arrays
from executive.confined.server import _computed, _forked, _write, serve
from executive.errors import ConfigError, DataError

HERE = "tests.confined.readers"


def request(name: str, file: Path, **other: Any) -> dict[str, Any]:
    return {
        "function": f"{HERE}:{name}",
        "path": file.name,
        "folder": str(file.parent),
        "processor_s": 10.0,
        "memory_bytes": 200_000_000,
        **other,
    }


@pytest.fixture
def files() -> Any:
    """Two open files in memory: for the answer, and for what is printed."""
    made = os.memfd_create("answer"), os.memfd_create("printed")
    yield made
    for one in made:
        os.close(one)


def test_a_child_reads_and_its_status_and_use_are_told(file: Path, files: Any) -> None:
    reply = _forked(request("arrays", file), *files)
    assert reply["status"] == 0
    assert 0.0 <= reply["processor_s"] < 10.0
    assert reply["added_bytes"] >= 0
    numbers, empty, flags = _arrays(file, SimpleNamespace(), files[0])
    assert np.array_equal(numbers, np.arange(12.0).reshape(3, 4))
    assert (empty.shape, flags.tolist()) == ((0, 3), [True, False, True])
    assert Path.cwd() != file.parent  # only the child went there


def test_what_a_child_prints_goes_to_its_file(file: Path, files: Any) -> None:
    assert _forked(request("exits", file), *files)["status"] == 3
    assert os.pread(files[1], 100, 0) == b"last words"


def test_a_child_that_cannot_begin_ends_with_status_1(file: Path, files: Any) -> None:
    gone = request("arrays", file, folder=str(file / "none"))
    assert _forked(gone, *files)["status"] == 1


def test_a_child_is_ended_by_a_signal_when_its_time_is_over(file: Path, files: Any) -> None:
    reply = _forked(request("computes_for_ever", file, processor_s=0.02), *files)
    assert reply["status"] == -signal.SIGPROF
    assert reply["processor_s"] >= 0.02


def test_a_child_has_no_more_memory_than_it_is_given(file: Path, files: Any) -> None:
    assert _forked(request("asks_for_much", file, memory_bytes=10_000_000), *files)["status"] == 0
    with pytest.raises(DataError, match="more than 10 MB"):
        _arrays(file, SimpleNamespace(file_bytes=7, memory_bytes=10e6), files[0])


def test_the_use_of_a_child_is_that_beyond_the_server(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    used = SimpleNamespace(ru_utime=1.5, ru_stime=0.25, ru_maxrss=4000)
    monkeypatch.setattr(os, "fork", lambda: 77)
    monkeypatch.setattr(os, "wait4", lambda child, options: (child, 3 << 8, used))
    monkeypatch.setattr(server, "_resident_bytes", lambda: 1_000_000)
    reply = _forked(request("arrays", file), 0, 0)
    assert reply == {"status": 3, "processor_s": 1.75, "added_bytes": 4000 * 1024 - 1_000_000}
    monkeypatch.setattr(server, "_resident_bytes", lambda: 5_000_000)
    assert _forked(request("arrays", file), 0, 0)["added_bytes"] == 0


def test_resident_memory_is_in_bytes() -> None:
    kilobytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert 0.1 * 1024 * kilobytes < server._resident_bytes() < 1.1 * 1024 * kilobytes


def test_it_serves_until_the_other_end_is_closed(
    file: Path, files: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    handlers: list[Any] = []
    monkeypatch.setattr(signal, "signal", lambda *given: handlers.append(given))
    received: list[int] = []
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)

    def answered(asked: dict[str, Any], answer: int, printed: int) -> dict[str, float]:
        assert os.fstat(answer).st_ino == os.fstat(files[0]).st_ino
        assert os.fstat(printed).st_ino == os.fstat(files[1]).st_ino
        received.extend((answer, printed))
        return {"status": asked["n"]}

    monkeypatch.setattr(server, "_forked", answered)
    with ours, theirs:
        for n in (4, 5):
            socket.send_fds(ours, [json.dumps({"n": n}).encode()], list(files))
        ours.shutdown(socket.SHUT_WR)
        serve(theirs)
        assert [json.loads(ours.recv(100))["status"] for _ in range(2)] == [4, 5]
    assert handlers == [(signal.SIGINT, signal.SIG_IGN)]
    assert len(received) == 4
    ours_only = {os.fstat(one).st_ino for one in files}
    for one in set(received):  # nothing is left open; a thread may have the number by now
        try:
            left = os.fstat(one).st_ino
        except OSError:
            continue
        assert left not in ours_only


@pytest.mark.parametrize(
    ("error", "kind", "told"),
    [
        (ConfigError("wrong setting"), "ConfigError", "wrong setting"),
        (DataError("torn"), "DataError", "torn"),
        (MemoryError(), "MemoryError", ""),
        (
            ValueError("a\n  b"),
            "DataError",
            "given.bin: cannot be read (ValueError: a b): damaged; copy or export it again",
        ),
        (KeyboardInterrupt(), "DataError", "given.bin: cannot be read (KeyboardInterrupt:): d"),
    ],
)
def test_what_a_reader_raises_stands_in_the_head(error, kind, told) -> None:
    def reader(path: Path) -> None:
        logging.getLogger("given").info("left out of the answer")
        logging.getLogger("given").warning("%d of %d left out", 3, 4)
        raise error

    before = list(logging.getLogger().handlers)
    head, arrays = _computed(reader, Path("given.bin"))
    for handler in set(logging.getLogger().handlers) - set(before):
        logging.getLogger().removeHandler(handler)
    assert (head["raised"], list(arrays), head["arrays"]) == (kind, [], [])
    assert head["text"].startswith(told)
    first, *rest = head["log"]
    assert first == ("given", logging.WARNING, "3 of 4 left out")
    unknown = "cannot be read" in told
    assert [(name, level) for name, level, _ in rest] == unknown * [
        ("executive.confined.server", logging.DEBUG)
    ]
    if unknown:
        assert rest[0][2].startswith("given.bin:\nTraceback")


def test_arrays_begin_at_multiples_of_64_bytes(files: Any) -> None:
    arrays = [np.arange(3, dtype="u1"), np.empty((0, 3)), np.arange(4.0).reshape(2, 2)]
    _write(files[0], {"a": 1}, arrays)
    size = os.fstat(files[0]).st_size
    with mmap.mmap(files[0], size) as whole:
        length = int.from_bytes(whole[:8], "little")
        assert json.loads(whole[8 : 8 + length]) == {"a": 1}
        assert 8 + length < 64
        assert whole[64:67] == bytes([0, 1, 2])
        assert np.frombuffer(whole[128:160], float).tolist() == [0.0, 1.0, 2.0, 3.0]
    assert size == 160
