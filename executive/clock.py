"""The mission's only source of time: the mission's own, and that of the machine.

Mission time stands still in a pause, and while the operator is asked. Machine time is what the
stamps of observations are given in: it goes on while the machine comes to rest, and on the wall
clock for as long as the pause lasts. Without a pause the two are the same.
"""

import os
import select
import time
from abc import ABC, abstractmethod
from contextlib import suppress

_IDLE_S = 0.02  # on the wall: how often a pause in lock-step looks whether it is over


class Clock(ABC):
    """Source of the mission's time; `advance` ends a tick.

    Attributes:
        is_paused: Whether mission time stands still.
        paused_s: Machine time that has passed in pauses [s].
    """

    is_paused = False
    paused_s = 0.0

    def __init__(self) -> None:
        self._pauses: list[tuple[float, float]] = []  # mission time, and `paused_s` after it

    @property
    def stands_at_rest(self) -> bool:
        """Whether machine time stands still, too, once the machine is at rest in a pause."""
        return False

    @abstractmethod
    def now_s(self) -> float:
        """Return the mission's time since its start [s]."""

    @abstractmethod
    def go_on_at(self, tick: int, tick_s: float, now_s: float, machine_s: float) -> None:
        """Go on with a mission that was cut off: its time, its machine's, and its next tick."""

    @abstractmethod
    def machine_s(self) -> float:
        """Return the machine's time since the mission's start [s]: that of stamps."""

    @abstractmethod
    def advance(self, dt_s: float) -> float:
        """End the current tick, which lasts `dt_s` seconds; return by how much it was late [s]."""

    def start(self) -> None:  # noqa: B027 - optional
        """Let time begin now: the machine and the plugins took some time to start."""

    def pause(self) -> None:
        """Let mission time stand still from now on; nothing if it does."""
        self.is_paused = True

    def resume(self) -> None:
        """Let mission time go on."""
        if self.is_paused:
            self.is_paused = False
            self._pauses.append((self.now_s(), self.paused_s))

    def machine_at(self, mission_s: float) -> float:
        """Return the machine's time at an earlier mission time [s].

        At the very time of a pause it is the time at which the pause began.
        """
        before = [paused_s for at_s, paused_s in self._pauses if at_s < mission_s]
        return mission_s + (before[-1] if before else 0.0)

    @abstractmethod
    def idle(self) -> None:
        """Wait a moment on the wall, where nothing moves and no time passes."""

    def wait_for(self, latest_s: float) -> None:  # noqa: B027 - optional
        """Stand still if the machine's time can be no later than this by now [s]."""

    def wake(self) -> None:  # noqa: B027 - optional
        """End a wait of `advance` early; may be called by a signal handler or another thread."""


class SimulatedClock(Clock):
    """Lock-step time: tick n is at exactly n·dt, however long computations take."""

    def __init__(self) -> None:
        super().__init__()
        self._ticks = self._paused_ticks = 0
        self._dt_s = 0.0

    @property
    def stands_at_rest(self) -> bool:
        """A simulated machine at rest is held: a pause is as long as its stop, on any computer."""
        return True

    def now_s(self) -> float:
        return self._ticks * self._dt_s

    def go_on_at(self, tick: int, tick_s: float, now_s: float, machine_s: float) -> None:
        self._ticks, self._dt_s = round(now_s / tick_s), tick_s
        self._paused_ticks = round((machine_s - now_s) / tick_s)
        self.paused_s = self._paused_ticks * tick_s

    def machine_s(self) -> float:
        return (self._ticks + self._paused_ticks) * self._dt_s

    def advance(self, dt_s: float) -> float:
        if self._ticks + self._paused_ticks and dt_s != self._dt_s:
            raise ValueError(
                f"a lock-step clock has ticks of one length: {self._dt_s} s, got {dt_s} s"
            )
        self._dt_s = dt_s
        if self.is_paused:
            self._paused_ticks += 1
            self.paused_s = self._paused_ticks * dt_s
        else:
            self._ticks += 1
        return 0.0

    def idle(self) -> None:
        time.sleep(_IDLE_S)  # noqa: TID251 - only the clock itself may wait


class WallClock(Clock):
    """Monotonic wall time; `advance` waits until dt after the last tick.

    After a late tick the schedule begins again at the present time. When the machine's clock is
    behind, this one stands still until both agree again.
    """

    def __init__(self) -> None:
        super().__init__()
        self._origin_s = time.monotonic()
        self._next_s = 0.0
        self._slipped_s = 0.0
        self._shown_s = 0.0  # the latest machine time that was told: time never goes back
        self._paused_at_s = 0.0
        self._paused_before_s = 0.0
        # A pipe, because a signal handler may write to it at any moment without a lock.
        self._awake, self._waker = os.pipe()
        for end in (self._awake, self._waker):
            os.set_blocking(end, False)

    def __del__(self) -> None:
        os.close(self._awake)
        os.close(self._waker)

    def start(self) -> None:
        self._origin_s = time.monotonic()
        self._next_s = self._slipped_s = self._shown_s = 0.0

    def machine_s(self) -> float:
        self._shown_s = max(self._shown_s, time.monotonic() - self._origin_s - self._slipped_s)
        return self._shown_s

    def wait_for(self, latest_s: float) -> None:
        self._slipped_s = max(time.monotonic() - self._origin_s - latest_s, 0.0)

    def go_on_at(self, tick: int, tick_s: float, now_s: float, machine_s: float) -> None:
        self._origin_s = time.monotonic() - machine_s
        self._next_s = self._shown_s = machine_s
        self._slipped_s = 0.0
        self.paused_s = self._paused_before_s = machine_s - now_s

    def now_s(self) -> float:
        machine_s = self._paused_at_s if self.is_paused else self.machine_s()
        return machine_s - self._paused_before_s

    def pause(self) -> None:
        if not self.is_paused:
            self._paused_at_s = self.machine_s()
        super().pause()

    def resume(self) -> None:
        if self.is_paused:
            self._paused_before_s += self.machine_s() - self._paused_at_s
            self.paused_s = self._paused_before_s
        super().resume()

    def advance(self, dt_s: float) -> float:
        now_s = self.machine_s()
        due_s = self._next_s + dt_s
        self._next_s = min(max(due_s, now_s), now_s + dt_s)  # also while the clock stands still
        if self._next_s > now_s:
            self._wait(self._next_s - now_s)
        return max(now_s - due_s, 0.0)

    def idle(self) -> None:
        self._wait(_IDLE_S)

    def wake(self) -> None:
        with suppress(BlockingIOError):  # full of wakes that nobody has read: it wakes all the same
            os.write(self._waker, b".")

    def _wait(self, remaining_s: float) -> None:
        if select.select([self._awake], [], [], remaining_s)[0]:
            os.read(self._awake, 1024)


def wall_s() -> float:
    """Return monotonic wall time [s], for durations in reports only, never for decisions."""
    return time.monotonic()


def thread_s() -> float:
    """Return processor time of the calling thread [s], for reports only, as `wall_s`."""
    return time.thread_time()
