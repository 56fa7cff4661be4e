"""A supervisor's own connection with the machine."""

import time
from collections.abc import Mapping
from typing import Any

from executive.errors import ConfigError
from executive.wire.address import Address
from executive.wire.connection import Connection
from executive.wire.frame import Frame, Kind, WireError

_CONNECT_S = 0.1  # on one computer it takes 0.2 ms
_AGAIN_S = 0.5  # between two attempts to connect


class MachineLink:
    """Listens to the machine's own reports, and can stop it.

    Attributes:
        report: The newest status of the machine; empty before the first.
    """

    def __init__(self) -> None:
        self._connection: Connection | None = None
        self._tried_s = -_AGAIN_S
        self.report: Mapping[str, Any] = {}
        self.heard_s = 0.0

    def keep(self, address: str) -> None:
        """Connect if there is an address and no connection, and take what has arrived."""
        if address and not self._is_open():
            self._connect(address)
        if self._connection is None or not self._connection.is_open:
            return
        try:
            for frame in self._connection.receive():
                if frame.kind in (Kind.STATUS, Kind.WELCOME):
                    self.report, self.heard_s = frame.head, time.monotonic()
        except WireError:
            self._connection.close()

    def stop(self, reason: str) -> bool:
        """Let the machine make a safe stop; return whether the command was sent."""
        if self._connection is None:
            return False
        return self._connection.send(Frame(Kind.SAFE_STOP, {"reason": reason}))

    def close(self) -> None:
        """End the connection; the machine goes on."""
        if self._connection is not None:
            self._connection.close()

    def _is_open(self) -> bool:
        return self._connection is not None and self._connection.is_open

    def _connect(self, address: str) -> None:
        if time.monotonic() - self._tried_s < _AGAIN_S:
            return
        self._tried_s = time.monotonic()
        try:
            self._connection = Connection(Address.parse(address).connect(_CONNECT_S))
        except (OSError, ConfigError):
            return
        self._connection.send(Frame(Kind.HELLO, {"role": "supervisor"}))
