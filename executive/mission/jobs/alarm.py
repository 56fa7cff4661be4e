"""Ends a computation of the main thread that takes too long."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from executive.mission.jobs.patience import Patience

_AGAIN_S = 1.0  # between alarms, for code that catches the first one


class Overdue(BaseException):
    """Raised at the line that the main thread is at; no plugin's `except Exception` catches it."""


@contextmanager
def alarm(patience: Patience) -> Iterator[None]:
    """Raise `Overdue` within the block when patience with it has ended.

    The exception is raised between two instructions of Python: a library that does not return to
    Python is not ended, and neither is a block in another thread than the main one.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def ring(_signal: int, _frame: object) -> None:
        if more_s := patience.more_s():
            signal.setitimer(signal.ITIMER_REAL, more_s, _AGAIN_S)
            return
        raise Overdue

    handler = signal.signal(signal.SIGALRM, ring)
    timer = signal.setitimer(signal.ITIMER_REAL, patience.limit_s, _AGAIN_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, *timer)
        signal.signal(signal.SIGALRM, handler)
