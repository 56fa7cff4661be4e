"""Readers that answer, refuse, die, and never end."""

import logging
import os
import signal
import sys
from pathlib import Path

import numpy as np

from executive.errors import ConfigError


def arrays(path: Path) -> list[np.ndarray]:
    assert path.read_bytes() == b"content"
    turned = np.arange(12.0).reshape(4, 3, order="F").T.reshape(3, 4, order="C")
    flags = np.array([True, False, True])
    return [turned, np.empty((0, 3), dtype="i8"), flags]


def refuses(path: Path) -> list[np.ndarray]:
    logging.getLogger("given").warning("%d of %d left out", 3, 4)
    raise ConfigError(f"{path}: wrong setting")


def raises(path: Path) -> list[np.ndarray]:
    return [np.array(1 // 0)]


def exits(path: Path) -> list[np.ndarray]:
    os.write(2, b"last words")
    os._exit(3)


def segfaults(path: Path) -> list[np.ndarray]:
    os.kill(os.getpid(), signal.SIGSEGV)
    return []


def asks_for_much(path: Path) -> list[np.ndarray]:
    return [np.ones(300_000_000, dtype=np.uint8)]


def aborts_for_memory(path: Path) -> list[np.ndarray]:
    os.write(2, b"memory allocation of 24000000000 bytes failed")
    os.abort()


def computes_for_ever(path: Path) -> list[np.ndarray]:
    while True:
        sys.getsizeof(path)


def waits_for_ever(path: Path) -> list[np.ndarray]:
    signal.pause()
    return []
