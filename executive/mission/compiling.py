"""Compiling of numerical code: a first run on a computer takes minutes for it, and says so."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import thread_time

from numba.core.event import Event, Listener, install_listener

# Code that a plugin compiles in every run, as numba cannot keep it, takes less [s].
TOLD_AFTER_S = 2.0
NOTICE = (
    "numerical code is being compiled, which takes some minutes; it is kept, and later runs begin"
    " at once"
)


class Compiling(Listener):  # type: ignore[misc]  # numba has no types
    """Measures what compiling takes in this process, and says once that it goes on.

    Args:
        tell: Called once with what a person should know, if compiling takes more than a moment.

    Attributes:
        spent_s: Processor time of compiling so far [s].
    """

    def __init__(self, tell: Callable[[str], None]) -> None:
        self.spent_s = 0.0
        self._tell = tell
        self._is_told = False
        self._depth = 0  # a function is compiled within the compiling of one that calls it
        self._begun_s = 0.0

    def on_start(self, event: Event) -> None:
        """Note the beginning; numba's lock lets one thread compile at a time."""
        if self._depth == 0:
            self._begun_s = thread_time()
        self._depth += 1

    def on_end(self, event: Event) -> None:
        """Add what it took, and tell as soon as that is more than a moment."""
        self._depth -= 1
        if self._depth == 0:
            self.spent_s += thread_time() - self._begun_s
        if self.spent_s > TOLD_AFTER_S and not self._is_told:
            self._is_told = True
            self._tell(NOTICE)

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Watch for code that is compiled in this process."""
        with install_listener("numba:compile", self):
            yield
