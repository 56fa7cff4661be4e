"""The sockets of the Groot2 protocol: requests at one port, breakpoints published at the next.

Both are bound to 127.0.0.1: the protocol knows no users and no passwords.
"""

import contextlib
import socket
import threading
from collections import deque
from collections.abc import Callable, Sequence

import zmq

from executive.errors import ConfigError
from executive.mission.groot.protocol import notice_header

_HOST = "127.0.0.1"
_MOST_BYTES = 2**20  # of a request


class Publisher:
    """Serves requests in a thread until `close`."""

    def __init__(self, port: int) -> None:
        """Take the ports; nobody is answered before `serve`.

        Args:
            port: Port of the requests; breakpoints are published at the next one.

        Raises:
            ConfigError: If a port is in use.
        """
        self._context = zmq.Context()
        self._requests, self._notices = self._bound(zmq.REP, port), self._bound(zmq.PUB, port + 1)
        self._woken, self._waker = socket.socketpair()
        self._waker.setblocking(False)
        self._reached: deque[int] = deque()
        self._numbers = 0
        self._is_closed = False
        self._thread = threading.Thread(target=self._run, name="groot", daemon=True)
        self._reply: Callable[[Sequence[bytes]], list[bytes]] = lambda parts: []

    def serve(self, reply: Callable[[Sequence[bytes]], list[bytes]]) -> None:
        """Answer requests from now on, by a function that is called in another thread."""
        self._reply = reply
        self._thread.start()

    def publish(self, uid: int) -> None:
        """Tell clients that the tree waits at a node; returns at once."""
        self._reached.append(uid)
        self._wake()

    def close(self) -> None:
        """Answer no more, and free the ports."""
        self._is_closed = True
        if self._thread.is_alive():
            self._wake()
            self._thread.join(timeout=1.0)
        for one in (self._woken, self._waker):
            one.close()
        self._context.destroy(linger=0)

    def _bound(self, kind: int, port: int) -> zmq.Socket[bytes]:
        made = self._context.socket(kind)
        made.setsockopt(zmq.LINGER, 0)
        made.setsockopt(zmq.MAXMSGSIZE, _MOST_BYTES)
        try:
            made.bind(f"tcp://{_HOST}:{port}")
        except zmq.ZMQError as error:
            self._context.destroy(linger=0)
            raise ConfigError(
                f"--groot: port {port} of {_HOST} cannot be used: {error.strerror}; choose another "
                "by --groot-port (the next one is used as well)"
            ) from error
        return made

    def _wake(self) -> None:
        with contextlib.suppress(OSError):
            self._waker.send(b".")

    def _run(self) -> None:
        poller = zmq.Poller()
        poller.register(self._requests, zmq.POLLIN)
        poller.register(self._woken, zmq.POLLIN)
        while not self._is_closed:
            ready = dict(poller.poll())
            if self._woken.fileno() in ready:
                self._woken.recv(4096)
            while self._reached:
                self._numbers += 1
                uid = str(self._reached.popleft()).encode()
                self._notices.send_multipart([notice_header(self._numbers), uid])
            if self._requests in ready:
                self._requests.send_multipart(self._reply(self._requests.recv_multipart()))
