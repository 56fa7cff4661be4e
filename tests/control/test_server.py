"""The control socket: one user's, short to name, and never a burden for the loop."""

import json
import os
import socket
import stat
import threading
import time

import pytest

from executive.control.client import ask
from executive.control.place import NAME, connect
from executive.control.request import MOST_BYTES, Reply, Request, Verb
from executive.control.server import ControlServer
from executive.errors import ConfigError, DataError
from executive.mission.run_lock import RunLock

PAUSE = Request(Verb.PAUSE)


@pytest.fixture
def woken():
    return threading.Event()


@pytest.fixture
def server(tmp_path, woken):
    made = ControlServer(tmp_path, woken.set)
    yield made
    made.close()


def replies(connection, count=1):
    with connection.makefile("rb") as lines:
        return [Reply.read(lines.readline()) for _ in range(count)]


def serve_one(server, woken, text="held"):
    assert woken.wait(20)
    woken.clear()
    asked = server.asked.popleft()
    server.reply(asked, Reply(True, text))
    return asked


def test_a_request_is_answered_by_the_loop_and_names_who_asks(tmp_path, server, woken):
    with connect(tmp_path, 20) as connection:
        connection.sendall(PAUSE.line())
        asked = serve_one(server, woken)
        assert (asked.request, asked.person.pid) == (PAUSE, os.getpid())
        assert asked.person.uid == os.geteuid()
        assert replies(connection) == [Reply(True, "held")]


def test_the_socket_is_for_its_user_alone_and_goes_with_the_run(tmp_path, woken):
    server = ControlServer(tmp_path, woken.set)
    assert stat.S_IMODE((tmp_path / NAME).stat().st_mode) == 0o600
    server.close()
    assert not (tmp_path / NAME).exists()


def test_a_folder_may_have_a_path_that_no_socket_could_have(tmp_path, woken):
    folder = tmp_path / ("a" * 120) / ("b" * 120)
    folder.mkdir(parents=True)
    server = ControlServer(folder, woken.set)
    with connect(folder, 20) as connection:
        connection.sendall(PAUSE.line())
        serve_one(server, woken)
        assert replies(connection)[0].is_done
    server.close()


def test_the_socket_of_a_run_that_was_killed_is_replaced(tmp_path, woken):
    left = socket.socket(socket.AF_UNIX)
    left.bind(str(tmp_path / NAME))
    left.close()
    server = ControlServer(tmp_path, woken.set)
    with connect(tmp_path, 20) as connection:
        connection.sendall(PAUSE.line())
        assert serve_one(server, woken).request == PAUSE
    server.close()


@pytest.mark.parametrize(
    ("line", "told"),
    [
        (b"\x00\xff\n", "one line of JSON"),
        (b"[1]\n", "an object of texts"),
        (b'{"verb": 3}\n', "an object of texts"),
        (b'{"verb": "puase"}\n', "Did you mean 'pause'"),
        (b'{"verb": "pause", "nod": "x"}\n', "Did you mean 'node'"),
        (b"[" * 4000 + b"\n", "one line of JSON"),
    ],
)
def test_garbage_is_refused_without_the_loop(tmp_path, server, line, told):
    with connect(tmp_path, 20) as connection:
        connection.sendall(line)
        found = replies(connection)[0]
    assert not found.is_done
    assert told in found.text
    assert not server.asked


def test_a_line_without_an_end_is_cut_off(tmp_path, server):
    with connect(tmp_path, 20) as connection:
        connection.sendall(b"x" * (MOST_BYTES + 1))
        assert "at most" in replies(connection)[0].text
        assert connection.recv(1) == b""


def test_clients_that_hang_or_flood_keep_nobody_out(tmp_path, server, woken):
    hanging = [connect(tmp_path, 20) for _ in range(40)]
    hanging[-1].sendall(b'{"verb": "pau')
    for _ in range(200):
        try:
            hanging[-2].sendall(PAUSE.line())
        except OSError:  # it was sent away
            break
    with connect(tmp_path, 20) as connection:
        while server.asked:
            server.reply(server.asked.popleft(), Reply(True, "flood"))
        connection.sendall(Request(Verb.STOP).line())
        while not any(one.request.verb is Verb.STOP for one in server.asked):
            assert woken.wait(20)
            woken.clear()
        server.reply(server.asked.pop(), Reply(True, "stopped"))
        assert replies(connection) == [Reply(True, "stopped")]
    for one in hanging:
        one.close()


def test_a_client_that_asks_and_never_reads_is_sent_away(tmp_path, server, woken):
    with connect(tmp_path, 20) as deaf, pytest.raises((BrokenPipeError, ConnectionResetError)):
        deaf.sendall(b"{}\n" * 100_000)
    with connect(tmp_path, 20) as connection:
        connection.sendall(PAUSE.line())
        serve_one(server, woken)
        assert replies(connection)[0].is_done


def test_a_client_that_reads_late_gets_all_its_replies_whole(tmp_path, server, woken):
    """A reply is longer than the socket takes at once: the rest is sent when there is room."""
    texts = [str(number) * 600_000 for number in range(2)]
    with connect(tmp_path, 20) as connection:
        for text in texts:
            connection.sendall(PAUSE.line())
            serve_one(server, woken, text)
        assert [one.text for one in replies(connection, 2)] == texts
        connection.sendall(PAUSE.line())
        serve_one(server, woken)
        assert replies(connection) == [Reply(True, "held")]


def test_two_clients_at_once_get_each_its_own_reply(tmp_path, server, woken):
    first, second = connect(tmp_path, 20), connect(tmp_path, 20)
    first.sendall(PAUSE.line())
    serve_one(server, woken, "first")
    second.sendall(PAUSE.line())
    serve_one(server, woken, "second")
    assert replies(second) == [Reply(True, "second")]
    assert replies(first) == [Reply(True, "first")]
    first.close()
    second.close()


def test_a_client_that_goes_before_its_reply_does_no_harm(tmp_path, server, woken):
    with connect(tmp_path, 20) as connection:
        connection.sendall(PAUSE.line())
        assert woken.wait(20)
    server.reply(server.asked.popleft(), Reply(True, "too late"))
    with connect(tmp_path, 20) as connection:
        connection.sendall(b"{}\n")
        assert not replies(connection)[0].is_done


def keep_sending(connection, data, limit_s=5.0):
    until_s = time.monotonic() + limit_s
    while time.monotonic() < until_s:
        connection.sendall(data)
        time.sleep(0.005)


def test_a_client_that_does_not_take_its_reply_is_sent_away(tmp_path, server, woken):
    with connect(tmp_path, 20) as connection:
        connection.sendall(PAUSE.line())
        assert woken.wait(20)
        connection.shutdown(socket.SHUT_RD)  # it still asks, and listens no more
        server.reply(server.asked.popleft(), Reply(True, "held"))
        with pytest.raises(OSError, match=r"Broken pipe|reset"):
            keep_sending(connection, b" ")  # of a line without an end, which is not answered


def test_the_client_says_why_nobody_answers(tmp_path):
    with pytest.raises(ConfigError, match="no folder of a run"):
        ask(tmp_path / "none", PAUSE, 1)
    with pytest.raises(ConfigError, match="holds no run"):
        ask(tmp_path, PAUSE, 1)
    (tmp_path / "journal.jsonl").touch()
    with pytest.raises(ConfigError, match=r"was cut off; `executive resume`"):
        ask(tmp_path, PAUSE, 1)
    (tmp_path / "report.json").write_text(json.dumps({"outcome": "stopped"}))
    with pytest.raises(ConfigError, match=r"has ended \(stopped\)"):
        ask(tmp_path, PAUSE, 1)


def test_a_loop_that_does_not_answer_in_time_is_told(tmp_path, server):
    with pytest.raises(ConfigError, match=r"did not answer within 0.05 s.*--timeout"):
        ask(tmp_path, PAUSE, 0.05)


def test_a_reply_that_is_none_is_refused():
    with pytest.raises(DataError, match="cannot be read"):
        Reply.read(b'{"is_done": true, "txt": ""}\n')


def test_words_of_any_language_are_sent_as_they_are():
    line = Reply(True, "angehalten für eine Prüfung").line()
    assert "für eine Prüfung".encode() in line
    assert line.count(b"\n") == 1
    assert Reply.read(line) == Reply(True, "angehalten für eine Prüfung")


def test_a_run_that_starts_or_ends_is_asked_again_later(tmp_path):
    (tmp_path / "journal.jsonl").touch()
    lock = RunLock(tmp_path)  # it writes into the folder, and does not listen
    with pytest.raises(ConfigError, match="is starting or ending, and takes no requests then"):
        ask(tmp_path, PAUSE, 1)
    lock.release()
    with pytest.raises(ConfigError, match="was cut off"):
        ask(tmp_path, PAUSE, 1)
