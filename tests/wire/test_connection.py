"""One end of the wire over a pair of sockets: whole frames, full buffers, and an end that goes."""

import socket
from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from executive.wire import connection
from executive.wire.connection import Connection
from executive.wire.frame import Frame, Kind

SMALL = Frame(Kind.STATUS, {"n": 1}, b"body", 7)
LARGE = Frame(Kind.STATUS, {}, bytes(4 << 20))


@pytest.fixture
def ends() -> Iterator[tuple[Connection, socket.socket]]:
    ours, theirs = socket.socketpair()
    one = Connection(ours)
    yield one, theirs
    one.close()
    theirs.close()


def test_frames_arrive_as_they_were_sent(ends: tuple[Connection, socket.socket]) -> None:
    one, theirs = ends
    other = Connection(theirs)
    assert one.send(SMALL) is True
    assert one.send(Frame(Kind.STATUS, {"n": 2})) is True
    first, second = other.receive(1.0)
    assert (first.kind, first.head, bytes(first.body), first.sequence) == (
        Kind.STATUS,
        {"n": 1},
        b"body",
        7,
    )
    assert second.head == {"n": 2}
    assert list(other.receive()) == []
    assert one.is_open
    assert other.is_open


def test_an_end_that_takes_nothing_has_failed_after_a_quarter_of_a_second(
    ends: tuple[Connection, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    one, _ = ends
    waits: list[float] = []

    def waits_in_vain(reads: list, writes: list, errors: list, left_s: float) -> tuple:
        assert (reads, errors, len(writes)) == ([], [], 1)
        waits.append(left_s)
        return [], [], []

    monkeypatch.setattr(connection, "select", SimpleNamespace(select=waits_in_vain))
    assert one.send(LARGE) is False
    assert not one.is_open
    assert len(waits) == 1
    assert 0.2 < waits[0] <= 0.25


def test_an_end_that_takes_again_in_time_gets_the_whole_frame(
    ends: tuple[Connection, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    one, theirs = ends
    taken = bytearray()

    def takes(reads: list, writes: list, errors: list, left_s: float) -> tuple:
        taken.extend(theirs.recv(1 << 22))
        return reads, writes, errors

    monkeypatch.setattr(connection, "select", SimpleNamespace(select=takes))
    assert one.send(LARGE) is True
    theirs.setblocking(False)
    while len(taken) < len(LARGE.packed()):
        taken.extend(theirs.recv(1 << 22))
    assert bytes(taken) == LARGE.packed()


def test_a_slow_end_has_a_quarter_of_a_second_for_a_frame_and_not_for_each_part(
    ends: tuple[Connection, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    one, theirs = ends
    now = iter([0.0, 0.1, 0.2, 0.3, 0.4])
    monkeypatch.setattr(connection, "time", SimpleNamespace(monotonic=lambda: next(now)))
    waits: list[float] = []

    def takes_a_little(reads: list, writes: list, errors: list, left_s: float) -> tuple:
        waits.append(left_s)
        theirs.recv(1000)
        return reads, writes, errors

    monkeypatch.setattr(connection, "select", SimpleNamespace(select=takes_a_little))
    assert one.send(LARGE) is False
    assert waits == pytest.approx([0.15, 0.05])


def test_what_is_posted_is_kept_and_sent_when_there_is_room(
    ends: tuple[Connection, socket.socket],
) -> None:
    one, theirs = ends
    assert not one.has_kept
    assert one.post(SMALL) is True
    assert not one.has_kept
    assert one.post(LARGE) is True
    assert one.has_kept
    expected = SMALL.packed() + LARGE.packed()
    taken = bytearray()
    while len(taken) < len(expected):
        taken.extend(theirs.recv(1 << 20))
        assert one.flush() is True
    assert bytes(taken) == expected
    assert not one.has_kept


def test_an_end_that_leaves_too_much_is_given_up(
    ends: tuple[Connection, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    one, _ = ends
    monkeypatch.setattr(connection, "_KEPT_BYTES", 6 << 20)
    assert one.post(LARGE) is True
    assert one.post(LARGE) is False
    assert not one.is_open
    assert not one.has_kept


@pytest.mark.parametrize("way", ["send", "post"])
def test_an_end_that_is_gone_is_told(ends: tuple[Connection, socket.socket], way: str) -> None:
    one, theirs = ends
    theirs.close()
    assert getattr(one, way)(SMALL) is False
    assert not one.is_open
    assert one.fileno() == -1
    assert list(one.receive(10.0)) == []  # nothing to wait for
    one.close()


def test_frames_that_came_before_the_other_end_went_are_received(
    ends: tuple[Connection, socket.socket],
) -> None:
    one, theirs = ends
    theirs.sendall(SMALL.packed())
    theirs.close()
    assert [frame.head for frame in one.receive()] == [{"n": 1}]
    assert not one.is_open
