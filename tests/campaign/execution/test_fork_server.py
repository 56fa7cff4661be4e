"""The server that forks the processes of runs, and what these do, in this process."""

import os
import pickle
import signal
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from executive.campaign.execution.processes import fork_server, isolated_run, process_ties
from executive.campaign.execution.processes.fork_protocol import (
    Begin,
    Begun,
    Ended,
    Exited,
    LastWord,
)
from executive.campaign.execution.processes.fork_server import ForkServer, _last_word
from executive.campaign.trial import Limits, Trial

TRIAL = Trial(3, "made_up", {"a": 1}, 42, {}, Limits(10.0, 10**9))
WORD = LastWord(Ended.RAISED, "KeyError: 'x'")


class Connection:
    """Keeps what is sent, and whether it was closed."""

    def __init__(self, *asked: Any) -> None:
        self.asked = list(asked)
        self.sent: list[Any] = []
        self.is_closed = False

    def recv(self) -> Any:
        if not self.asked:
            raise EOFError
        return self.asked.pop(0)

    def send(self, value: Any) -> None:
        self.sent.append(value)

    def close(self) -> None:
        self.is_closed = True


@pytest.fixture
def prepared(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What a work prepares; no object is frozen in this process."""
    done: list[Any] = []
    work = SimpleNamespace(prepare=lambda *given: done.append(given))
    monkeypatch.setattr(fork_server, "work_of", lambda trial: (work, dict(trial.arguments)))
    monkeypatch.setattr(fork_server.gc, "collect", lambda: done.append("collect"))
    monkeypatch.setattr(fork_server.gc, "freeze", lambda: done.append("freeze"))
    return done


def begin(run: int, folder: Path, trial: Trial = TRIAL) -> Begin:
    return Begin(run, trial, folder, {"log": folder})


def test_a_run_is_forked_and_its_process_told(
    prepared: list[Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    connection = Connection()
    server = ForkServer(connection)
    done = prepared
    output = SimpleNamespace(flush=lambda: done.append("flush"))

    def fork() -> int:
        done.append("fork")
        return 4711

    monkeypatch.setattr(os, "fork", fork)
    monkeypatch.setattr(fork_server.sys, "stdout", output)
    monkeypatch.setattr(fork_server.sys, "stderr", output)
    server._begin(begin(5, tmp_path))
    # What is not printed yet would be printed by the child once more.
    assert done == [({"a": 1}, {"log": tmp_path}), "collect", "freeze", "flush", "flush", "fork"]
    assert connection.sent == [Begun(5, 4711)]
    child = server._children[4711]
    assert child.run == 5
    assert os.get_blocking(child.last_word) is False
    assert os.read(child.last_word, 1) == b""  # nobody here can write to it
    os.close(child.last_word)


@pytest.mark.parametrize(("threads", "way"), [(1, "forked"), (2, "anew")])
def test_a_child_leaves_what_is_the_server_s_and_begins(
    prepared: list[Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, threads: int, way: str
) -> None:
    class GoneError(BaseException):
        pass

    begun: list[Any] = []

    def ends(name: str) -> Any:
        def end(asked: Begin, writing: int) -> None:
            with pytest.raises(BrokenPipeError):  # the end that is read is the server's alone
                os.write(writing, b"x")
            os.close(writing)
            begun.append((name, asked))
            raise GoneError

        return end

    woken: list[int] = []
    monkeypatch.setattr(os, "fork", lambda: 0)
    monkeypatch.setattr(signal, "set_wakeup_fd", woken.append)
    monkeypatch.setattr(fork_server, "number_of_threads", lambda: threads)
    monkeypatch.setattr(fork_server, "exec_run", ends("anew"))
    monkeypatch.setattr(fork_server, "run_and_exit", ends("forked"))
    connection = Connection()
    server = ForkServer(connection)
    other, writing = os.pipe()
    server._children[12] = fork_server._Child(1, other)
    asked = begin(5, tmp_path)
    with pytest.raises(GoneError):
        server._begin(asked)
    os.close(writing)
    assert connection.is_closed
    assert woken == [-1]
    with pytest.raises(OSError, match="Bad file"):
        os.close(other)
    assert begun == [(way, asked)]


def test_a_work_is_prepared_once_for_its_arguments(prepared: list[Any], tmp_path: Path) -> None:
    server = ForkServer(Connection())
    other = Trial(4, "made_up", {"a": 2}, 42, {}, TRIAL.limits)
    for trial in (TRIAL, TRIAL, other):
        server._prepare(begin(1, tmp_path, trial))
    inputs = {"log": tmp_path}
    assert prepared == [
        ({"a": 1}, inputs), "collect", "freeze", ({"a": 2}, inputs), "collect", "freeze"
    ]  # fmt: skip


def test_a_work_that_cannot_prepare_is_left_to_the_run(
    prepared: list[Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def fails(trial: Trial) -> None:
        raise ImportError("no such module")

    monkeypatch.setattr(fork_server, "work_of", fails)
    ForkServer(Connection())._prepare(begin(1, tmp_path))
    assert prepared == ["collect", "freeze"]


def piped(data: bytes) -> int:
    reading, writing = os.pipe()
    os.set_blocking(reading, False)
    os.write(writing, data)
    os.close(writing)
    return reading


@pytest.mark.parametrize(
    ("data", "word"),
    [
        (pickle.dumps(WORD), WORD),
        (b"", None),
        (b"torn", None),
        (pickle.dumps(WORD)[:-5], None),
        (pickle.dumps("a word of another kind"), None),
    ],
)
def test_a_last_word_is_read_whole_or_not_at_all(data: bytes, word: LastWord | None) -> None:
    descriptor = piped(data)
    assert _last_word(descriptor) == word
    with pytest.raises(OSError, match="Bad file"):
        os.close(descriptor)


def test_the_end_of_each_child_is_reported_and_its_group_killed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    connection = Connection()
    server = ForkServer(connection)
    server._children = {
        11: fork_server._Child(1, piped(pickle.dumps(WORD))),
        12: fork_server._Child(2, piped(b"")),
    }
    ended = iter((11, 99, 12, None))  # 99 is an orphan that a run has left
    killed: list[Any] = []
    usage = SimpleNamespace(ru_utime=1.5, ru_stime=0.25, ru_maxrss=2000)
    status = {11: 1 << 8, 99: 0, 12: int(signal.SIGKILL)}
    monkeypatch.setattr(fork_server, "_ended", lambda: next(ended))
    monkeypatch.setattr(os, "killpg", lambda *given: killed.append(given))
    monkeypatch.setattr(os, "wait4", lambda pid, options: (pid, status[pid], usage))
    server._report_ended()
    assert connection.sent == [
        Exited(1, 1, 1.75, 2000 * 1024, WORD),
        Exited(2, -9, 1.75, 2000 * 1024, None),
    ]
    assert killed == [(11, signal.SIGKILL), (12, signal.SIGKILL)]
    assert server._children == {}


def test_who_has_ended_is_asked_without_waiting_and_left_to_be_waited_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []
    found: Any = SimpleNamespace(si_pid=7)

    def waitid(*given: int) -> Any:
        asked.append(given)
        return found

    monkeypatch.setattr(os, "waitid", waitid)
    assert fork_server._ended() == 7
    assert asked == [(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)]
    found = None
    assert fork_server._ended() is None

    def without_children(*_: int) -> None:
        raise ChildProcessError

    monkeypatch.setattr(os, "waitid", without_children)
    assert fork_server._ended() is None


@pytest.fixture
def descendants(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What a server kills at its end; signals of this process stay as they are."""
    killed: list[str] = []

    class Process:
        def children(self, recursive: bool) -> list[Any]:
            assert recursive
            gone = SimpleNamespace(kill=lambda: (_ for _ in ()).throw(fork_server.psutil.Error))
            return [gone, SimpleNamespace(kill=lambda: killed.append("orphan"))]

    monkeypatch.setattr(fork_server.psutil, "Process", Process)
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    monkeypatch.setattr(signal, "set_wakeup_fd", lambda fd, **_: fd)
    return killed


def test_it_serves_until_the_campaign_is_gone_and_kills_what_is_left(
    descendants: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked = [begin(1, tmp_path), begin(2, tmp_path)]
    connection = Connection(*asked)
    server = ForkServer(connection)
    done: list[Any] = []
    monkeypatch.setattr(server, "_begin", done.append)
    monkeypatch.setattr(server, "_report_ended", lambda: done.append("ended"))
    read = []
    monkeypatch.setattr(os, "read", lambda fd, most: read.append((fd, most)))
    rounds = iter((False, True, False))

    def ready(watched: list[Any]) -> list[Any]:
        return [one for one in watched if one is connection or next(rounds)]

    monkeypatch.setattr(fork_server, "wait", ready)
    server.serve()
    assert done == [asked[0], "ended", asked[1]]
    assert len(read) == 1
    assert read[0][1] >= 1
    assert descendants == ["orphan"]


def test_the_end_of_a_child_wakes_it(
    descendants: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    handled: list[Any] = []
    woken: list[Any] = []
    monkeypatch.setattr(signal, "signal", lambda *given: handled.append(given))
    monkeypatch.setattr(
        signal, "set_wakeup_fd", lambda *given, **named: woken.append((given, named))
    )
    server = ForkServer(Connection())
    told: list[str] = []
    monkeypatch.setattr(server, "_report_ended", lambda: told.append("ended"))
    pipe: list[int] = []

    def ready(watched: list[Any]) -> list[Any]:
        connection, wake = watched
        (((signalled,), _),) = woken
        if not pipe:
            pipe.extend((wake, signalled))
            assert not any(map(os.get_blocking, pipe))  # a full or empty pipe stops nobody
            os.write(signalled, b"x" * 3)
            return [wake]
        with pytest.raises(BlockingIOError):
            os.read(wake, 1)  # it was emptied
        return [connection]

    monkeypatch.setattr(fork_server, "wait", ready)
    server.serve()
    for one in pipe:
        os.close(one)
    ((number, handler),) = handled
    assert number == signal.SIGCHLD
    assert callable(handler)  # ignored, it would wake nobody
    assert woken[0][1] == {"warn_on_full_buffer": False}
    assert told == ["ended"]


def test_a_server_that_cannot_fork_says_why(
    descendants: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: Any
) -> None:
    server = ForkServer(Connection(begin(1, tmp_path)))

    def fails(asked: Begin) -> None:
        raise OSError(11, "no process is left")

    monkeypatch.setattr(server, "_begin", fails)
    monkeypatch.setattr(fork_server, "wait", lambda watched: [watched[0]])
    server.serve()
    assert "no process is left" in capsys.readouterr().err
    assert descendants == ["orphan"]


def test_its_process_adopts_serves_and_exits(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[Any] = []
    monkeypatch.setattr(fork_server, "adopt_orphans", lambda: done.append("adopts"))
    monkeypatch.setattr(fork_server, "Connection", lambda fd: f"connection {fd}")
    server = lambda connection: SimpleNamespace(serve=lambda: done.append(connection))
    monkeypatch.setattr(fork_server, "ForkServer", server)
    monkeypatch.setattr(os, "_exit", done.append)
    fork_server.main("17")
    assert done == ["adopts", "connection 17", 0]


# --- The process of a run


@pytest.fixture
def ended(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The exit statuses; the process takes no place of its own."""
    statuses: list[int] = []
    monkeypatch.setattr(os, "_exit", statuses.append)
    monkeypatch.setattr(isolated_run, "_take_place", lambda folder: None)
    return statuses


@pytest.mark.parametrize(("word", "status"), [(LastWord(Ended.ANSWERED), 0), (WORD, 1)])
def test_a_run_says_its_last_word_and_exits(
    ended: list[int], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, word: LastWord, status: int
) -> None:
    reading, writing = os.pipe()
    monkeypatch.setattr(isolated_run, "_worked", lambda asked: word)
    isolated_run.run_and_exit(begin(1, tmp_path), writing)
    os.close(writing)
    assert _last_word(reading) == word
    assert ended == [status]


def test_a_run_that_cannot_take_its_place_says_why(
    ended: list[int], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: Any
) -> None:
    def fails(folder: Path) -> None:
        raise PermissionError(13, "denied", str(folder))

    reading, writing = os.pipe()
    monkeypatch.setattr(isolated_run, "_take_place", fails)
    isolated_run.run_and_exit(begin(1, tmp_path), writing)
    os.close(writing)
    said = _last_word(reading)
    assert said is not None
    assert said.ended is Ended.RAISED
    assert said.reason.startswith("PermissionError: [Errno 13] denied")
    assert ended == [1]
    assert "denied" in capsys.readouterr().err


def test_a_run_prints_into_its_folder_and_ends_with_its_server(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    done: list[Any] = []
    (tmp_path / isolated_run.OUTPUT).write_text("earlier\n")
    monkeypatch.setattr(os, "getppid", lambda: 4711)
    monkeypatch.setattr(os, "setsid", lambda: done.append("session"))
    monkeypatch.setattr(isolated_run, "die_with", done.append)
    monkeypatch.setattr(signal, "signal", lambda *given: done.append(given))
    monkeypatch.setattr(isolated_run.faulthandler, "enable", lambda: done.append("faults"))
    monkeypatch.setattr(isolated_run.sys, "stdout", SimpleNamespace(fileno=lambda: 901))
    monkeypatch.setattr(isolated_run.sys, "stderr", SimpleNamespace(fileno=lambda: 902))
    copied: list[int] = []

    def copy(descriptor: int, to: int) -> None:
        os.write(descriptor, f"to {to}\n".encode())
        copied.append(descriptor)

    monkeypatch.setattr(os, "dup2", copy)
    isolated_run._take_place(tmp_path)
    monkeypatch.undo()
    default = signal.SIG_DFL
    numbers = (signal.SIGCHLD, signal.SIGINT, signal.SIGTERM)
    assert done == ["session", 4711, *((one, default) for one in numbers), "faults"]
    assert (tmp_path / isolated_run.OUTPUT).read_text() == "earlier\nto 901\nto 902\n"
    with pytest.raises(OSError, match="Bad file"):
        os.fstat(copied[0])


def test_a_run_that_imports_anew_is_handed_over_on_standard_input(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked, handed = begin(1, tmp_path), []
    command: list[Any] = []

    def take(descriptor: int, to: int) -> None:
        handed.append((pickle.loads(os.read(descriptor, 1 << 16)), to))

    reading, writing = os.pipe()
    monkeypatch.setattr(isolated_run.sys, "stdin", SimpleNamespace(fileno=lambda: 900))
    monkeypatch.setattr(os, "dup2", take)
    monkeypatch.setattr(os, "execv", lambda *given: command.extend(given))
    isolated_run.exec_run(asked, writing)
    monkeypatch.undo()
    assert handed == [(asked, 900)]
    assert os.get_inheritable(writing)
    module = "executive.campaign.execution.processes.isolated_run"
    assert command == [
        isolated_run.sys.executable,
        isolated_run.python_command(module, str(writing)),
    ]
    os.close(reading)
    os.close(writing)


def test_the_handed_over_run_is_done(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import io

    asked, done = begin(1, tmp_path), []
    data = SimpleNamespace(buffer=io.BytesIO(pickle.dumps(asked)))
    monkeypatch.setattr(isolated_run.sys, "stdin", data)
    monkeypatch.setattr(isolated_run, "run_and_exit", lambda *given: done.append(given))
    isolated_run.main("17")
    assert done == [(asked, 17)]


# --- Ties


@pytest.fixture
def prctl(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What the system is asked for."""
    asked: list[Any] = []
    library = SimpleNamespace(prctl=lambda *given: asked.append(given))
    monkeypatch.setattr(process_ties.ctypes, "CDLL", lambda name, use_errno: library)
    return asked


@pytest.mark.parametrize(("parent", "exits"), [(4711, []), (1, [1])])
def test_a_process_dies_with_its_parent_also_if_that_has_ended_before(
    prctl: list[Any], monkeypatch: pytest.MonkeyPatch, parent: int, exits: list[int]
) -> None:
    ended: list[int] = []
    monkeypatch.setattr(os, "getppid", lambda: parent)
    monkeypatch.setattr(os, "_exit", ended.append)
    process_ties.die_with(4711)
    assert prctl == [(1, signal.SIGKILL, 0, 0, 0)]  # prctl(2): PR_SET_PDEATHSIG
    assert ended == exits


def test_orphans_are_adopted_on_linux_alone(
    prctl: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    process_ties.adopt_orphans()
    assert prctl == [(36, 1, 0, 0, 0)]  # prctl(2): PR_SET_CHILD_SUBREAPER
    monkeypatch.setattr(process_ties.sys, "platform", "darwin")
    process_ties.adopt_orphans()
    assert len(prctl) == 1


def test_a_module_is_run_with_this_path_and_its_argument() -> None:
    python, option, code, argument = process_ties.python_command("a.b", "17")
    assert (python, option, argument) == (process_ties.sys.executable, "-c", "17")
    assert code.startswith(f"import sys; sys.path[:] = {process_ties.sys.path!r}; ")
    assert code.endswith("from a.b import main; main(sys.argv[1])")
