"""Signals of a mission that runs: a stop along the path, an end at once, a pause."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from executive.mission.mission import Mission
from executive.mission.stop_signals import Aborted, stopping
from executive.supervision.child import ORPHANED


@contextmanager
def stop_on_interrupt(mission: Mission) -> Iterator[None]:
    """Turn signals into requests: the first stops along the path, the second ends the run at once,
    and SIGUSR1 pauses and resumes; the death of the supervisor leaves the run as a crash would.
    Only the main thread takes signals.
    """

    def stop(number: int) -> None:
        if number > 1:
            raise Aborted("stopped at once by the operator")
        mission.request_stop()

    with stopping(stop):
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = signal.signal(signal.SIGUSR1, lambda *_: mission.toggle_pause())
        signal.signal(ORPHANED, lambda *_: mission.be_orphaned())
        try:
            yield
        finally:
            signal.signal(signal.SIGUSR1, before)
            signal.signal(ORPHANED, signal.SIG_IGN)  # the machine stands; the report is written
