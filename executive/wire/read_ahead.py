"""An end of a connection that takes what arrives at once, however busy its owner is."""

import socket
import threading
from collections.abc import Iterator
from contextlib import suppress
from queue import Empty, SimpleQueue

from executive.wire.connection import Connection
from executive.wire.frame import Frame, WireError

_LOOK_S = 1.0  # between two looks of a thread to which nothing comes


class ReadAheadConnection(Connection):
    """A connection whose frames are taken from the system by a thread of its own.

    The system keeps some 0.2 MB for whoever reads, and two lidars send a megabyte in two ticks of
    a loop. Were it read once a tick, the other end could send no faster than that, and an answer
    would wait behind all the scans that were measured before it.
    """

    def __init__(self, found: socket.socket) -> None:
        super().__init__(found)
        self._inbox: SimpleQueue[Frame | WireError | None] = SimpleQueue()
        self._ahead = Connection(found.dup())
        threading.Thread(target=self._take, name="robot wire", daemon=True).start()

    def receive(self, wait_s: float = 0.0) -> Iterator[Frame]:
        while self.is_open:  # nothing comes after the end
            try:
                one = self._inbox.get(timeout=wait_s) if wait_s > 0 else self._inbox.get_nowait()
            except Empty:
                return
            if one is None:
                self.close()
                return
            if isinstance(one, WireError):
                raise one
            yield one
            wait_s = 0.0

    def close(self) -> None:
        with suppress(OSError):  # closed already, or the other end was first
            self._socket.shutdown(socket.SHUT_RDWR)
        super().close()

    def _take(self) -> None:
        try:
            while self._ahead.is_open:
                for frame in self._ahead.receive(_LOOK_S):
                    self._inbox.put(frame)
        except WireError as error:
            self._inbox.put(error)
        self._inbox.put(None)
        self._ahead.close()
