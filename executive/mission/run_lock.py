"""One process writes into a run's folder at a time; the lock ends with the process."""

import fcntl
import os
from pathlib import Path

from executive.errors import ConfigError

LOCK = "lock"  # the file in a run's folder; it stays when the run has ended


class RunLock:
    """Holds the lock of a folder until `release`, or until this process ends."""

    def __init__(self, folder: Path) -> None:
        """Take the lock.

        Raises:
            ConfigError: If another run holds it, or the folder cannot be written.
        """
        path = folder / LOCK
        try:
            self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise ConfigError(
                f"the run folder {folder} cannot be written: {error.strerror}"
            ) from error
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            holder = os.read(self._file, 20).decode(errors="replace").strip()
            os.close(self._file)
            raise ConfigError(
                f"another run writes into {folder} (process {holder or 'unknown'}); wait for its "
                "end, or give another --run-dir"
            ) from error
        os.ftruncate(self._file, 0)
        os.write(self._file, f"{os.getpid()}\n".encode())

    def release(self) -> None:
        """Let another run write."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
