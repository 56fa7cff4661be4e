"""An end that reads ahead: the other one gets rid of all that it has, before anybody looks."""

import select
import socket

import pytest

from executive.wire.connection import Connection
from executive.wire.frame import Frame, Kind, WireError
from executive.wire.read_ahead import ReadAheadConnection

LARGE = bytes(8 * 2**20)  # the system keeps 0.2 to 8 MB for a reader that does not read
LIMIT_S = 60.0


@pytest.fixture
def ends():
    """The machine's end, and the one that reads ahead."""
    one, other = socket.socketpair()
    found = Connection(one), ReadAheadConnection(other)
    yield found
    for end in found:
        end.close()


def test_a_large_frame_leaves_while_the_owner_does_not_look(ends):
    machine, executive = ends
    for _ in range(3):
        machine.post(Frame(Kind.OBSERVATIONS, body=LARGE))
    while machine.has_kept:
        assert select.select([], [machine], [], LIMIT_S)[1], "nobody takes it"
        machine.flush()
    machine.post(Frame(Kind.DONE, sequence=7))
    found = []
    while not found or found[-1].kind is not Kind.DONE:
        found += executive.receive(LIMIT_S)
    assert [one.kind for one in found] == [Kind.OBSERVATIONS] * 3 + [Kind.DONE]
    assert found[0].body == LARGE


def test_a_look_finds_nothing_where_nothing_came_and_does_not_wait(ends):
    assert list(ends[1].receive(0.0)) == []


def test_what_came_before_the_end_is_found_before_the_end(ends):
    machine, executive = ends
    machine.send(Frame(Kind.REFUSED, {"reason": "it is driven"}))
    machine.close()
    found = executive.receive(LIMIT_S)
    assert next(found).head == {"reason": "it is driven"}
    assert executive.is_open
    assert list(found) + list(executive.receive(LIMIT_S)) == []
    assert not executive.is_open


def test_what_is_no_frame_is_an_error_where_it_is_read():
    one, other = socket.socketpair()
    executive = ReadAheadConnection(other)
    one.sendall(b"GET / HTTP/1.1\r\n\r\n")
    with pytest.raises(WireError, match="no frame of the robot wire"):
        list(executive.receive(LIMIT_S))
    executive.close()
    one.close()


def test_the_other_end_learns_that_it_was_closed(ends):
    machine, executive = ends
    executive.close()
    executive.close()
    assert list(machine.receive(LIMIT_S)) == []
    assert not machine.is_open
