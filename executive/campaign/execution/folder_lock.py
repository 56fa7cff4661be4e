"""One campaign at a time in a folder."""

import fcntl
import os
import socket
from pathlib import Path

from executive.errors import ConfigError


class FolderInUseError(ConfigError):
    """Another campaign works in the folder."""


class FolderLock:
    """Held by the campaign that works in a folder; the system releases it when the process ends."""

    def __init__(self, path: Path) -> None:
        """Take the lock.

        Raises:
            FolderInUseError: If another process holds it; the message names it.
        """
        self._file = path.open("a+", encoding="utf-8")
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self._file.seek(0)
            holder = self._file.read().strip() or "another process"
            self._file.close()
            raise FolderInUseError(
                f"{path.parent}: a campaign works here already ({holder}); wait for its end, stop "
                "it, or give another --out. Nothing was changed"
            ) from None
        self._file.truncate(0)
        self._file.write(f"process {os.getpid()} on {socket.gethostname()}\n")
        self._file.flush()

    def release(self) -> None:
        """Let another campaign work in the folder."""
        self._file.close()
