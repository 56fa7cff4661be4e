"""The end of the control socket that the run holds: a thread that reads requests.

The thread parses and refuses; the loop takes what is left from a queue, where it can. No client can
hold the loop up: it never reads or writes a socket.
"""

import contextlib
import os
import selectors
import socket
import struct
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from executive.control.place import NAME, listen
from executive.control.request import MOST_BYTES, Person, Reply, Request, Verb
from executive.errors import DataError

_MOST_CLIENTS = 16  # the one that has been silent for longest goes when another comes
_MOST_EACH = 4  # requests of one client that wait, so that none keeps the others out
_MOST_WAITING = _MOST_CLIENTS * _MOST_EACH  # for the loop; replies for a client that does not read
_CREDENTIALS = struct.Struct("3i")  # of SO_PEERCRED: pid, uid, gid


@dataclass(eq=False, slots=True)
class Client:
    """One connection.

    Attributes:
        socket: Its socket.
        person: Who is at its other end.
        read: What has come of a line that is not whole.
        unsent: Replies, and the rest of one that the socket did not take at once.
        taken: Number of its requests that were put before the loop, written by the thread.
        answered: Number of these that were replied to, written by the loop.
    """

    socket: socket.socket
    person: Person
    read: bytes = b""
    unsent: deque[bytes] = field(default_factory=deque)
    taken: int = 0
    answered: int = 0


@dataclass(frozen=True, slots=True)
class Asked:
    """A request that waits for the loop."""

    request: Request
    client: Client

    @property
    def person(self) -> Person:
        """Return who asks."""
        return self.client.person


class ControlServer:
    """Listens in a run's folder until `close`.

    Attributes:
        asked: Requests that wait, the oldest first; the loop takes them by `popleft`.
        looks: The same of those that only ask for the status, which takes longer to tell.
    """

    def __init__(self, folder: Path, wake: Callable[[], None]) -> None:
        """Listen.

        Args:
            folder: The run's folder.
            wake: Called from another thread when a request has come.

        Raises:
            OSError: If the folder's file system takes no sockets.
        """
        self._folder = folder
        self._wake = wake
        self._listening = listen(folder)
        self._woken, self._waker = socket.socketpair()
        for one in (self._woken, self._waker):
            one.setblocking(False)
        self._clients: dict[Client, None] = {}  # the one that was heard last at the end
        self._is_closed = False
        self.asked: deque[Asked] = deque()
        self.looks: deque[Asked] = deque()
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._listening, selectors.EVENT_READ)
        self._selector.register(self._woken, selectors.EVENT_READ)
        self._thread = threading.Thread(target=self._run, name="control", daemon=True)
        self._thread.start()

    def reply(self, asked: Asked, reply: Reply) -> None:
        """Answer a request; called by the loop."""
        asked.client.unsent.append(reply.line())
        asked.client.answered += 1
        self._nudge()

    def close(self) -> None:
        """Send what is unsent, end all connections, and remove the socket's file."""
        self._is_closed = True
        self._nudge()
        self._thread.join(timeout=1.0)
        with contextlib.suppress(OSError):
            os.unlink(self._folder / NAME)

    def _nudge(self) -> None:
        with contextlib.suppress(OSError):  # full of nudges: the thread wakes all the same
            self._waker.send(b".")

    # --- the thread

    def _run(self) -> None:
        while not self._is_closed:
            for key, events in self._selector.select():
                if key.fileobj is self._listening:
                    self._accept()
                elif key.fileobj is self._woken:
                    self._woken.recv(4096)
                elif key.data in self._clients:
                    self._serve(key.data, events)
            for client in [one for one in self._clients if one.unsent]:
                self._send(client)
                if len(client.unsent) > _MOST_WAITING:
                    self._drop(client)
        for client in list(self._clients):
            self._drop(client)
        for one in (self._listening, self._woken, self._waker):
            one.close()
        self._selector.close()

    def _accept(self) -> None:
        try:
            found, _ = self._listening.accept()
        except OSError:  # it has gone again
            return
        found.setblocking(False)
        raw = found.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
        pid, uid, _ = _CREDENTIALS.unpack(raw)
        if uid not in (0, os.geteuid()):  # the file's mode keeps others out as well
            found.close()
            return
        if len(self._clients) >= _MOST_CLIENTS:
            self._drop(next(iter(self._clients)))
        client = Client(found, Person(uid, pid))
        self._clients[client] = None
        self._selector.register(found, selectors.EVENT_READ, client)

    def _serve(self, client: Client, events: int) -> None:
        if not events & selectors.EVENT_READ:  # what is unsent goes out after all are served
            return
        try:
            found = client.socket.recv(MOST_BYTES)
        except OSError:
            found = b""
        if not found:
            self._drop(client)
            return
        self._clients[client] = self._clients.pop(client)
        *lines, client.read = (client.read + found).split(b"\n")
        for line in lines:
            self._take(client, line)
        if len(client.read) > MOST_BYTES:
            client.unsent.append(Reply(False, f"a request has at most {MOST_BYTES} bytes").line())
            self._send(client)
            self._drop(client)

    def _take(self, client: Client, line: bytes) -> None:
        try:
            request = Request.read(line)
        except DataError as error:
            client.unsent.append(Reply(False, str(error)).line())
            return
        waiting = self.looks if request.verb is Verb.STATUS else self.asked
        is_busy = client.taken - client.answered >= _MOST_EACH
        if is_busy or len(waiting) >= _MOST_WAITING:
            client.unsent.append(Reply(False, "too many requests wait; ask again").line())
            return
        client.taken += 1
        waiting.append(Asked(request, client))
        self._wake()

    def _send(self, client: Client) -> None:
        """Send as much as the socket takes, and wait for it to take the rest."""
        try:
            while client.unsent:
                sent = client.socket.send(client.unsent[0])
                rest = client.unsent.popleft()[sent:]
                if rest:
                    client.unsent.appendleft(rest)
        except BlockingIOError:
            pass
        except OSError:
            self._drop(client)
            return
        wanted = selectors.EVENT_READ | (selectors.EVENT_WRITE if client.unsent else 0)
        if client in self._clients:
            self._selector.modify(client.socket, wanted, client)

    def _drop(self, client: Client) -> None:
        if client not in self._clients:
            return
        del self._clients[client]
        self._selector.unregister(client.socket)
        client.socket.close()
