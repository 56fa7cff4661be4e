"""What asks a run to stop: Ctrl-C, SIGTERM, and SIGHUP of a closed terminal, at any moment.

While a run starts, nothing moves, and it ends at once. While it goes on, the mission stops along
its path. While it ends, its report is written first.
"""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from executive.supervision.early_stop import STOPPING, TOLD


class Aborted(BaseException):
    """The operator wants the run to end at once."""


@contextmanager
def stopping(take: Callable[[int], None]) -> Iterator[None]:
    """Call a function with the number of the request, from 1; only the main thread takes signals.

    Args:
        take: Called within a signal handler: it sets something, or raises `Aborted`.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    asked = 0

    def handle(_signal: int, _frame: object) -> None:
        nonlocal asked
        asked += 1
        take(asked)

    before = {number: signal.signal(number, handle) for number in STOPPING}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def stop_at_once(_number: int) -> None:
    """End a run that starts: nothing has moved.

    Raises:
        Aborted: Always.
    """
    raise Aborted(TOLD)


def stop_after_report(number: int) -> None:
    """Let the report of a run that ends be written; a second request gives it up.

    Raises:
        Aborted: At the second request.
    """
    if number > 1:
        raise Aborted("stopped while the report was written")
