"""Ends a computation of the main thread that takes too long."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from executive.clock import wall_s
from executive.mission.jobs.patience import Patience

_AGAIN_S = 1.0  # between alarms, for code that catches the first one
_AT_ONCE_S = 1e-6  # 0 would switch a timer off


class Overdue(BaseException):
    """Raised at the line that the main thread is at; no plugin's `except Exception` catches it."""


@contextmanager
def alarm(patience: Patience) -> Iterator[None]:
    """Raise `Overdue` within the block when patience with it has ended.

    The exception is raised between two instructions of Python: a library that does not return to
    Python is not ended, and neither is a block in another thread than the main one. A timer that
    runs already goes on, and rings after the block if its time has passed in it.
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
    begun_s = wall_s()
    left_s, again_s = signal.setitimer(signal.ITIMER_REAL, patience.limit_s, _AGAIN_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, handler)
        if left_s:
            left_s = max(left_s - (wall_s() - begun_s), _AT_ONCE_S)
            signal.setitimer(signal.ITIMER_REAL, left_s, again_s)
