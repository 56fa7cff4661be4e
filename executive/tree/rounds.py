"""The bound on the work of one tick: how many rounds and attempts may begin in it."""

from collections.abc import Iterator
from contextlib import contextmanager

ROUNDS_IN_A_TICK = 1000


class Rounds:
    """Counts the rounds that the loops of a tree begin in one visit of the outermost one.

    Loops inside one another share the bound. A loop that finds none left goes on at the next tick,
    so that a loop of instant rounds without an end cannot stop the mission's loop.
    """

    def __init__(self) -> None:
        self._left = ROUNDS_IN_A_TICK
        self._depth = 0

    @contextmanager
    def tick(self) -> Iterator[None]:
        """Visit a loop; the outermost one begins to count anew."""
        if self._depth == 0:
            self._left = ROUNDS_IN_A_TICK
        self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1

    def take(self) -> bool:
        """Begin a round, if one is left in this tick."""
        self._left -= 1
        return self._left >= 0
