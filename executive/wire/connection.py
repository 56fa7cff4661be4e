"""One end of a connection of the robot wire."""

import select
import socket
import time
from collections import deque
from collections.abc import Iterator

from executive.wire.frame import LARGEST_BYTES, Frame, FrameReader

_CHUNK = 1 << 18
_KEPT_BYTES = 2 * LARGEST_BYTES  # the largest survey, or some sixty revolutions of a lidar
_SEND_S = 0.25  # an end that takes nothing for that long has failed


class Connection:
    """Sends and receives frames; `is_open` is False once the other end has gone."""

    def __init__(self, found: socket.socket) -> None:
        self._socket = found
        self._socket.setblocking(False)
        self._reader = FrameReader()
        self._arrived: deque[Frame] = deque()
        self._kept = bytearray()
        self.is_open = True

    def fileno(self) -> int:
        """Return the file descriptor, to wait for several connections at once."""
        return self._socket.fileno()

    def send(self, frame: Frame) -> bool:
        """Send a frame; return whether the other end is there and takes it."""
        data = memoryview(frame.packed())
        limit_s = time.monotonic() + _SEND_S
        while data and self.is_open:
            try:
                data = data[self._socket.send(data) :]
            except BlockingIOError:
                left_s = limit_s - time.monotonic()
                if left_s <= 0 or not select.select([], [self._socket], [], left_s)[1]:
                    self.close()
            except OSError:
                self.close()
        return self.is_open

    def post(self, frame: Frame) -> bool:
        """Send a frame without ever waiting; return whether the other end is there.

        What the other end does not take at once is kept, up to a bound beyond which it is given up.
        """
        self._kept += frame.packed()
        return self.flush()

    def flush(self) -> bool:
        """Send what `post` has kept, without waiting; return whether the other end is there."""
        while self._kept and self.is_open:
            try:
                del self._kept[: self._socket.send(self._kept)]
            except BlockingIOError:
                break
            except OSError:
                self.close()
        if len(self._kept) > _KEPT_BYTES:
            self.close()
        return self.is_open

    @property
    def has_kept(self) -> bool:
        """Whether there is something that the other end has not taken yet."""
        return self.is_open and bool(self._kept)

    def receive(self, wait_s: float = 0.0) -> Iterator[Frame]:
        """Yield the frames that have arrived; wait so long for the first one [s].

        Raises:
            WireError: If the other end sends no frames of this version; close the connection then.
        """
        if self.is_open and not self._arrived:
            select.select([self._socket], [], [], wait_s)
        self._read()
        while self._arrived:
            yield self._arrived.popleft()

    def _read(self) -> None:
        while self.is_open:
            try:
                data = self._socket.recv(_CHUNK)
            except BlockingIOError:
                return
            except OSError:
                data = b""
            if not data:
                self.close()
                return
            self._arrived.extend(self._reader.feed(data))

    def close(self) -> None:
        """Close the connection; a second time it does nothing."""
        self.is_open = False
        self._socket.close()
