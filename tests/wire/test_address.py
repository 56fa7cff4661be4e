"""Where a machine listens: addresses of this computer are read, others are refused."""

import socket
import stat

import pytest

from executive.errors import ConfigError
from executive.wire.address import Address


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("unix:/run/m.sock", Address("/run/m.sock")),
        ("unix:m", Address("m")),
        ("127.0.0.1:4600", Address("", 4600)),
        ("127.0.0.1:0", Address("", 0)),
        ("127.0.0.1:65535", Address("", 65535)),
    ],
)
def test_an_address_is_read_and_written(text, address):
    assert Address.parse(text) == address
    assert str(address) == text


@pytest.mark.parametrize(
    "text",
    ["unix:", "10.0.0.1:4600", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1",
     "localhost:4600", "", ":4600"],
)  # fmt: skip
def test_what_is_no_address_of_this_computer_is_refused(text):
    with pytest.raises(ConfigError, match=r"a machine's address is unix:PATH or 127\.0\.0\.1:PORT"):
        Address.parse(text)


def talk(listening, address):
    """Connect to a listening socket, and return what comes through."""
    with address.connect(5.0) as client:
        listening.setblocking(True)
        server, _ = listening.accept()
        with server:
            client.sendall(b"hello")
            delay = None
            if client.family == socket.AF_INET:
                delay = client.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
            return server.recv(5), delay


def test_a_port_of_this_computer_is_listened_at():
    with Address("", 0).listen() as listening:
        host, port = listening.getsockname()
        assert host == "127.0.0.1"
        assert not listening.getblocking()
        assert listening.getsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR)
        heard, has_no_delay = talk(listening, Address("", port))
        assert heard == b"hello"
        assert has_no_delay
        with pytest.raises(ConfigError, match=f"cannot listen at {host}:{port}: "):
            Address("", port).listen()


def test_a_unix_socket_is_for_its_user_alone(tmp_path):
    address = Address(str(tmp_path / "m.sock"))
    with address.listen() as listening:
        assert stat.S_IMODE((tmp_path / "m.sock").stat().st_mode) == 0o600
        assert not listening.getblocking()
        assert talk(listening, address) == (b"hello", None)


def test_a_socket_that_a_killed_process_left_is_replaced_and_a_living_one_stays(tmp_path):
    address = Address(str(tmp_path / "m.sock"))
    dead = socket.socket(socket.AF_UNIX)
    dead.bind(address.path)
    dead.close()
    with address.listen() as listening:
        assert talk(listening, address)[0] == b"hello"
        with pytest.raises(ConfigError, match=r"cannot listen at unix:.* in use"):
            address.listen()


def test_a_file_that_is_no_socket_is_left_alone(tmp_path):
    path = tmp_path / "notes"
    path.write_text("mine")
    with pytest.raises(ConfigError, match="cannot listen at unix:"):
        Address(str(path)).listen()
    assert path.read_text() == "mine"


def test_where_nobody_listens_there_is_no_connection(tmp_path):
    for address in (Address(str(tmp_path / "none")), Address("", 1)):
        with pytest.raises(OSError, match=r"No such file|refused"):
            address.connect(1.0)
