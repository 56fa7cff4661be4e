"""Wall times of a stage, of which a long run keeps a part that is spread evenly over it."""

from collections.abc import Iterator

_MOST = 20_000


class Samples:
    """Keeps every value at first, later every second, every fourth: memory is bounded.

    Attributes:
        total: Number of values so far.
    """

    def __init__(self) -> None:
        self.total = 0
        self._stride = 1
        self._kept: list[float] = []

    def append(self, value: float) -> None:
        """Take one value."""
        if self.total % self._stride == 0:
            self._kept.append(value)
        self.total += 1
        if len(self._kept) > _MOST:
            self._kept, self._stride = self._kept[::2], 2 * self._stride

    def __iter__(self) -> Iterator[float]:
        return iter(self._kept)

    def __len__(self) -> int:
        return len(self._kept)
