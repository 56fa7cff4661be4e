"""The server behind confined readings: it imports a reader once, and forks a process for each file.

The process for a file has limits of memory and processor time, so that whatever a damaged file does
to it costs one answer and no more. Run as `python -m executive.confined.server SOCKET`.
"""

import importlib
import json
import logging
import os
import resource
import signal
import socket
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from executive.confined.memory import MemoryLimit
from executive.errors import ConfigError, DataError, ExecutiveError

REQUEST_BYTES = 1 << 16
ALIGNMENT = 64  # bytes: arrays begin at multiples of it
_STANDARD_ERROR = 2


def serve(connection: socket.socket) -> None:
    """Answer requests until the other end is closed.

    A request is a JSON object with two open files: one that takes the answer, and one that takes
    what the process prints. The reply is a JSON object: the exit status of the process, negative
    for a signal, its processor time, and the memory that it had beyond that of the server.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    while True:
        data, files, _, _ = socket.recv_fds(connection, REQUEST_BYTES, 2)
        if not data:
            return
        reply = _forked(json.loads(data), *files)
        for file in files:
            os.close(file)
        connection.send(json.dumps(reply).encode())


def _forked(request: dict[str, Any], answer: int, printed: int) -> dict[str, float]:
    """Compute an answer in a child; return the child's exit status and what it used."""
    module, name = request["function"].split(":")
    function = getattr(importlib.import_module(module), name)  # kept for the files after this one
    child = os.fork()
    if child:
        _, ended, used = os.wait4(child, 0)
        return {
            "status": os.waitstatus_to_exitcode(ended),
            "processor_s": used.ru_utime + used.ru_stime,
            "added_bytes": max(0, 1024 * used.ru_maxrss - _resident_bytes()),
        }
    status = 1
    try:
        os.dup2(printed, _STANDARD_ERROR)
        os.chdir(request["folder"])
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.setitimer(signal.ITIMER_PROF, request["processor_s"])
        MemoryLimit(request["memory_bytes"])
        _write(answer, *_computed(function, Path(request["path"])))
        status = 0
    finally:
        os._exit(status)


def _resident_bytes() -> int:
    pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[1]
    return int(pages) * resource.getpagesize()


class _Kept(logging.Handler):
    """Keeps log records as (logger, level, text), for the process that asked."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.records: list[tuple[str, int, str]] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.records.append((record.name, record.levelno, record.getMessage()))


def _computed(function: Any, path: Path) -> tuple[dict[str, Any], Sequence[np.ndarray]]:
    """Return the head of the answer, and the arrays."""
    kept = _Kept()
    logging.getLogger().addHandler(kept)
    arrays: Sequence[np.ndarray] = ()
    raised, text = "", ""
    try:
        arrays = [np.ascontiguousarray(one) for one in function(path)]
    except MemoryError:
        raised = "MemoryError"
    except ExecutiveError as error:
        kind = ConfigError if isinstance(error, ConfigError) else DataError
        raised, text = kind.__name__, str(error)
    # What a library raises on a damaged file has no common class; a panic in Rust is not even an
    # Exception. The type stands in the message, the traceback in the log at DEBUG.
    except BaseException as error:
        raised, text = DataError.__name__, _unreadable(path, error)
        told = "".join(traceback.format_exception(error))
        kept.records.append((__name__, logging.DEBUG, f"{path}:\n{told}"))
    layout = [(one.dtype.str, one.shape) for one in arrays]
    return {"raised": raised, "text": text, "log": kept.records, "arrays": layout}, arrays


def _unreadable(path: Path, error: BaseException) -> str:
    reason = " ".join(f"{type(error).__name__}: {error}".split())
    return f"{path}: cannot be read ({reason}): damaged; copy or export it again"


def _write(answer: int, head: dict[str, Any], arrays: Sequence[np.ndarray]) -> None:
    """Write the head's size, the head and the arrays, each at a multiple of the alignment."""
    text = json.dumps(head).encode()
    with os.fdopen(os.dup(answer), "wb") as file:
        file.write(len(text).to_bytes(8, "little") + text)
        for one in arrays:
            file.write(bytes(-file.tell() % ALIGNMENT))
            file.write(one.reshape(-1).view(np.uint8).data if one.size else b"")


if __name__ == "__main__":
    serve(socket.socket(fileno=int(sys.argv[1])))
