"""Where a run's control socket lies: the file `control.sock` in the run's folder.

The path of a Unix socket has at most 107 bytes, and that of a run's folder may be longer. The
folder is therefore opened, and the socket named through the open folder: `/proc/self/fd/7/…`.
"""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

NAME = "control.sock"


@contextmanager
def short_path(folder: Path) -> Iterator[str]:
    """Give a short path to the socket of a folder.

    Raises:
        OSError: If the folder cannot be opened.
    """
    opened = os.open(folder, os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        yield f"/proc/self/fd/{opened}/{NAME}"
    finally:
        os.close(opened)


def listen(folder: Path) -> socket.socket:
    """Return a listening socket for this user alone.

    The caller holds the lock of the run's folder: a socket that lies there was left by a run that
    was killed, and is removed.

    Raises:
        OSError: If the folder's file system takes no sockets.
    """
    found = socket.socket(socket.AF_UNIX)
    try:
        with short_path(folder) as path:
            with suppress(FileNotFoundError):
                os.unlink(path)
            found.bind(path)
            os.chmod(path, 0o600)  # nobody can connect before `listen`
        found.listen()
    except OSError:
        found.close()
        raise
    found.setblocking(False)
    return found


def connect(folder: Path, timeout_s: float) -> socket.socket:
    """Return a connected socket.

    Raises:
        OSError: If nobody listens there.
    """
    found = socket.socket(socket.AF_UNIX)
    found.settimeout(timeout_s)
    try:
        with short_path(folder) as path:
            found.connect(path)
    except OSError:
        found.close()
        raise
    return found
