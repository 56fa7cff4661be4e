"""Signals: Ctrl-C once stops along the path, twice at once; SIGUSR1 pauses and resumes."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from executive.mission.mission import Mission


class Aborted(BaseException):
    """The operator pressed Ctrl-C twice: the run ends at once."""


@contextmanager
def stop_on_interrupt(mission: Mission) -> Iterator[None]:
    """Turn signals into requests while the mission runs; only the main thread takes signals."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    asked = 0

    def stop(_signal: int, _frame: object) -> None:
        nonlocal asked
        asked += 1
        if asked > 1:
            raise Aborted("stopped at once by the operator")
        mission.request_stop()

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    before[signal.SIGUSR1] = signal.signal(signal.SIGUSR1, lambda *_: mission.toggle_pause())
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
