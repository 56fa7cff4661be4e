"""Signals while the program loads: it ends at once, without a traceback; nothing has moved."""

import contextlib
import os
import signal
from collections.abc import Callable

STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
TOLD = "stopped while it was starting; nothing has moved"
_STATUS = 1  # of a run that somebody stopped
_STANDARD_ERROR = 2


def end_at_signals(finish: Callable[[int], None] = lambda status: None) -> None:
    """Let each signal that asks for a stop end this process, until others are in their place.

    Args:
        finish: Takes the exit status before the process ends.
    """

    def end(_signal: int, _frame: object) -> None:
        with contextlib.suppress(OSError):  # a terminal that is closed
            os.write(_STANDARD_ERROR, f"{TOLD}\n".encode())
        finish(_STATUS)
        os._exit(_STATUS)  # an exception would be printed by whatever is imported at the moment

    for number in STOPPING:
        signal.signal(number, end)


def take_defaults() -> None:
    """Let signals do what they do in any Python program."""
    for number in STOPPING:
        is_interrupt = number == signal.SIGINT
        signal.signal(number, signal.default_int_handler if is_interrupt else signal.SIG_DFL)
