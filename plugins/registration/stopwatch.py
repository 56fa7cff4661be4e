"""Wall time of named stages, for reports only."""

from collections.abc import Iterator
from contextlib import contextmanager

from executive.clock import wall_s


class Stopwatch:
    """Measures wall time by stage [ms]."""

    def __init__(self) -> None:
        self._begun_s = wall_s()
        self._stages: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time the body; a name used again adds up."""
        begun_s = wall_s()
        yield
        self._stages[name] = self._stages.get(name, 0.0) + (wall_s() - begun_s) * 1e3

    def timings_ms(self) -> dict[str, float]:
        """Return the finished stages, and `total` since the start."""
        return {**self._stages, "total": (wall_s() - self._begun_s) * 1e3}
