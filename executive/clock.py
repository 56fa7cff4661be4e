"""The mission's only source of time."""

import time
from abc import ABC, abstractmethod


class Clock(ABC):
    """Source of the mission's time; `advance` ends a tick."""

    @abstractmethod
    def now_s(self) -> float:
        """Return the time since the mission's start [s]."""

    @abstractmethod
    def go_on_at(self, tick: int, tick_s: float, now_s: float) -> None:
        """Go on with a mission that was cut off: this is its time, and the number of its tick."""

    @abstractmethod
    def advance(self, dt_s: float) -> None:
        """End the current tick, which lasts `dt_s` seconds."""


class SimulatedClock(Clock):
    """Lock-step time: tick n is at exactly n·dt, however long computations take."""

    def __init__(self) -> None:
        self._ticks = 0
        self._dt_s = 0.0

    def now_s(self) -> float:
        return self._ticks * self._dt_s

    def go_on_at(self, tick: int, tick_s: float, now_s: float) -> None:
        self._ticks, self._dt_s = round(now_s / tick_s), tick_s

    def advance(self, dt_s: float) -> None:
        if self._ticks and dt_s != self._dt_s:
            raise ValueError(
                f"a lock-step clock has ticks of one length: {self._dt_s} s, got {dt_s} s"
            )
        self._dt_s = dt_s
        self._ticks += 1


class WallClock(Clock):
    """Monotonic wall time; `advance` waits until dt after the last tick.

    After a late tick the schedule begins again at the present time.
    """

    def __init__(self) -> None:
        self._origin_s = time.monotonic()
        self._next_s = 0.0

    def now_s(self) -> float:
        return time.monotonic() - self._origin_s

    def go_on_at(self, tick: int, tick_s: float, now_s: float) -> None:
        self._origin_s = time.monotonic() - now_s
        self._next_s = now_s

    def advance(self, dt_s: float) -> None:
        self._next_s = max(self._next_s + dt_s, self.now_s())
        remaining_s = self._next_s - self.now_s()
        if remaining_s > 0:
            time.sleep(remaining_s)  # noqa: TID251 - only the clock itself may wait


def wall_s() -> float:
    """Return monotonic wall time [s], for durations in reports only, never for decisions."""
    return time.monotonic()
