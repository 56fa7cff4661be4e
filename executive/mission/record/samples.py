"""Values of a long run, such as durations, of which an evenly spread part is kept."""

from collections.abc import Iterator
from typing import Generic, TypeVar

Value = TypeVar("Value")

MOST = 5_000  # a percentile of 99 is then one of 25 values at least


class Samples(Generic[Value]):
    """Keeps every value at first, later every second, every fourth: memory is bounded.

    Attributes:
        total: Number of values so far.
    """

    def __init__(self, most: int = MOST) -> None:
        self.total = 0
        self._most = most
        self._stride = 1
        self._kept: list[Value] = []

    def append(self, value: Value) -> None:
        """Take one value."""
        if self.total % self._stride == 0:
            self._kept.append(value)
        self.total += 1
        if len(self._kept) > self._most:
            self._kept, self._stride = self._kept[::2], 2 * self._stride

    def __iter__(self) -> Iterator[Value]:
        return iter(self._kept)

    def __len__(self) -> int:
        return len(self._kept)
