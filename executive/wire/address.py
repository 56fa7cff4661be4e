"""Where a machine listens: a Unix socket, or a port of this computer."""

import socket
from dataclasses import dataclass
from pathlib import Path

from executive.errors import ConfigError

_HOST = "127.0.0.1"


@dataclass(frozen=True, slots=True)
class Address:
    """A local address; the wire has no encryption and no passwords, so that it leaves no computer.

    Attributes:
        path: Path of a Unix socket, or empty.
        port: TCP port of 127.0.0.1, where there is no path; 0 lets the system choose.
    """

    path: str
    port: int = 0

    @classmethod
    def parse(cls, text: str) -> "Address":
        """Read `unix:/run/machine.sock` or `127.0.0.1:4600`.

        Raises:
            ConfigError: If it is neither, or names another computer.
        """
        if text.startswith("unix:") and len(text) > len("unix:"):
            return cls(text.removeprefix("unix:"))
        host, _, port = text.rpartition(":")
        if host == _HOST and port.isdigit() and int(port) < 65536:
            return cls("", int(port))
        raise ConfigError(
            f"a machine's address is unix:PATH or {_HOST}:PORT, not '{text}'; the wire is not "
            "encrypted and stays on this computer"
        )

    def __str__(self) -> str:
        return f"unix:{self.path}" if self.path else f"{_HOST}:{self.port}"

    def listen(self) -> socket.socket:
        """Return a listening socket; a Unix socket is for this user alone.

        Raises:
            ConfigError: If the address is in use or cannot be made.
        """
        try:
            found = self._bound()
        except OSError as error:
            raise ConfigError(f"cannot listen at {self}: {error}") from error
        found.listen()
        found.setblocking(False)
        return found

    def _bound(self) -> socket.socket:
        found = socket.socket(socket.AF_UNIX if self.path else socket.AF_INET)
        try:
            if self.path:
                _remove_dead(Path(self.path))
                found.bind(self.path)
                Path(self.path).chmod(0o600)
            else:
                found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                found.bind((_HOST, self.port))
        except OSError:
            found.close()
            raise
        return found

    def connect(self, timeout_s: float) -> socket.socket:
        """Return a connected socket.

        Raises:
            OSError: If nothing listens there.
        """
        family = socket.AF_UNIX if self.path else socket.AF_INET
        found = socket.socket(family)
        found.settimeout(timeout_s)
        try:
            found.connect(self.path or (_HOST, self.port))
        except OSError:
            found.close()
            raise
        if not self.path:
            found.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return found


def _remove_dead(path: Path) -> None:
    """Remove a socket that a killed process left; one that somebody listens at stays."""
    if not path.is_socket():
        return
    with socket.socket(socket.AF_UNIX) as probe:
        try:
            probe.connect(str(path))
        except ConnectionRefusedError:
            path.unlink()
