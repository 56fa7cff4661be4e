"""The asking end of confined readings: it starts the server, asks it, and explains what went wrong.

Libraries in C, C++ and Rust that trust a file can crash, ask for all memory, or never end. Here
that is an error that names the file and the cure. A first reading costs the start of the server,
each further one a fork; arrays come back through shared memory, without a copy.
"""

import atexit
import json
import logging
import mmap
import os
import signal
import socket
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from executive.confined.allowance import Allowance
from executive.confined.server import ALIGNMENT
from executive.errors import ConfigError, DataError

_log = logging.getLogger(__name__)
_REPLY_BYTES = 1 << 12
# One thread for each numerical library: a process with threads cannot be forked safely.
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
_SHOWN_BYTES = 300  # of the end of what a process printed before it died
_OUT_OF_MEMORY = ("memory allocation of", "bad_alloc", "capacity overflow")
_CURE = "it is damaged, or larger than it looks; copy or export it again"


def read_confined(function: str, path: Path) -> list[np.ndarray]:
    """Return the arrays that a function reads from a file, in a process with limits.

    Args:
        function: Where it is, as `module:name`. It takes the path and returns arrays; it may raise
            `DataError` and `ConfigError`, and log warnings, which are logged here.
        path: The file.

    Raises:
        DataError: If the function raises it, dies, or exceeds the limits of `Allowance`.
        ConfigError: If the function raises it.
        OSError: If there is no such file.
    """
    allowance = Allowance.of(path)
    with _lock:
        server = _server()
        answer, printed = os.memfd_create("answer"), os.memfd_create("printed")
        try:
            status = server.ask(function, path, allowance, answer, printed)
            if status != 0:
                raise _death(path, allowance, status, os.pread(printed, 1 << 20, 0))
            return _arrays(path, allowance, answer)
        finally:
            os.close(answer)
            os.close(printed)


class _Server:
    """A running server and the connection to it."""

    def __init__(self) -> None:
        self.pid = os.getpid()
        self._connection, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            program = (
                f"import sys; sys.path[:] = {sys.path!r}; "
                "from executive.confined.server import serve; import socket; "
                f"serve(socket.socket(fileno={theirs.fileno()}))"
            )
            self._process = subprocess.Popen(
                [sys.executable, "-c", program],
                stdin=subprocess.DEVNULL,
                pass_fds=[theirs.fileno()],
                env=os.environ | _ONE_THREAD,
                start_new_session=True,  # killed as a group; Ctrl-C at a terminal does not reach it
            )
        atexit.register(self.close)

    @property
    def is_alive(self) -> bool:
        return self._process.poll() is None

    def ask(
        self, function: str, path: Path, allowance: Allowance, answer: int, printed: int
    ) -> int:
        """Return the exit status of the process that wrote the answer."""
        request = {
            "function": function,
            "path": str(path),
            "folder": os.getcwd(),
            "processor_s": allowance.processor_s,
            "memory_bytes": allowance.memory_bytes,
        }
        self._connection.settimeout(allowance.wall_s)
        try:
            socket.send_fds(self._connection, [json.dumps(request).encode()], [answer, printed])
            reply = self._connection.recv(_REPLY_BYTES)
        except TimeoutError:
            self.close()
            raise DataError(
                f"{path}: not read within {allowance.wall_s:.0f} s: {_CURE}, or look after the disk"
            ) from None
        except BaseException:  # such as Ctrl-C: a reply that comes later must not be taken up
            self.close()
            raise
        if not reply:
            self.close()
            raise DataError(f"{path}: the process that reads files ended; see what it printed")
        used: dict[str, Any] = json.loads(reply)
        _log.debug(
            "%s: read in %.3f s of processor time, with %d bytes of memory",
            path, used["processor_s"], used["added_bytes"],
        )  # fmt: skip
        return int(used["status"])

    def close(self) -> None:
        """End the server, and a reading that goes on."""
        atexit.unregister(self.close)
        self._connection.close()
        if self.pid == os.getpid():
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()


_lock = threading.Lock()
_running: list[_Server] = []


def _server() -> _Server:
    """Return the server of this process; a fork of this process gets one of its own."""
    if _running and not (_running[0].pid == os.getpid() and _running[0].is_alive):
        _running.pop().close()
    if not _running:
        _running.append(_Server())
    return _running[0]


def _death(path: Path, allowance: Allowance, status: int, printed: bytes) -> DataError:
    """Return the error for a process that died."""
    words = printed.decode(errors="replace")
    if -status == signal.SIGPROF:
        return DataError(
            f"{path}: reading its {allowance.file_bytes:,} bytes took more than "
            f"{allowance.processor_s:.1f} s: {_CURE}"
        )
    if any(one in words for one in _OUT_OF_MEMORY):
        return _too_large(path, allowance)
    how = signal.Signals(-status).name if status < 0 else f"exit status {status}"
    end = " ".join(words[-_SHOWN_BYTES:].split())
    return DataError(
        f"{path}: reading it ended the process that read it ({how}{': ' if end else ''}{end}): "
        "it is damaged; copy or export it again"
    )


def _too_large(path: Path, allowance: Allowance) -> DataError:
    return DataError(
        f"{path}: reading its {allowance.file_bytes:,} bytes asked for more than "
        f"{allowance.memory_bytes / 1e6:.0f} MB of memory: {_CURE}"
    )


def _arrays(path: Path, allowance: Allowance, answer: int) -> list[np.ndarray]:
    """Return the arrays of an answer, or raise what it tells."""
    size = os.fstat(answer).st_size
    with_head = mmap.mmap(answer, size, flags=mmap.MAP_PRIVATE)
    start = 8 + int.from_bytes(with_head[:8], "little")
    head: dict[str, Any] = json.loads(with_head[8:start])
    for name, level, text in head["log"]:
        logging.getLogger(name).log(level, "%s", text)
    if head["raised"]:
        if head["raised"] == "MemoryError":
            raise _too_large(path, allowance)
        raise {"ConfigError": ConfigError}.get(head["raised"], DataError)(head["text"])
    arrays = []
    for kind, shape in head["arrays"]:
        start += -start % ALIGNMENT
        count = int(np.prod(shape))
        whole = np.frombuffer(with_head, kind, count, start) if count else np.empty(0, kind)
        arrays.append(whole.reshape(shape))
        start += whole.nbytes
    return arrays
