"""What takes the time in a tick: the steps of the loop, the verbs in it, and the leaves."""

from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

from executive.clock import thread_s, wall_s

LOOP = "loop"  # what is in no step that has a name
LEAF = "leaf"  # the own code of a leaf, and what it calls of plugins without a job
WAKE = "wake"  # before the tick began: the loop woke up too late, or the machine's clock caught up


@dataclass(frozen=True, slots=True)
class Share:
    """What one step took of a tick.

    Attributes:
        step: The step: `capability.verb`, `leaf`, or a part of the loop such as `journal`.
        node: Path of the node in which that was; empty outside of the tree.
        took_s: Time on the wall, without that of steps within it [s].
        computed_s: Processor time of the loop's thread in it [s].
    """

    step: str
    node: str
    took_s: float
    computed_s: float


class TickTimes:
    """Adds up the time of a tick by what takes it; steps may lie within one another.

    Used by the loop's thread alone. In lock-step no tick is late, and nobody asks what took it:
    nothing is measured, since reading the clocks some hundred times a tick costs more than many a
    step.
    """

    def __init__(self, *, measures: bool = True) -> None:
        self._measures = measures
        self._within: list[tuple[str, str]] = [(LOOP, "")]
        self._totals: dict[tuple[str, str], tuple[float, float]] = {}
        self._marks = (wall_s(), thread_s()) if measures else (0.0, 0.0)

    def start(self) -> None:
        """Begin a tick."""
        self._totals.clear()
        if self._measures:
            self._marks = wall_s(), thread_s()

    def spent(self, step: str, node: str = "") -> "_Spent":
        """Return the context in which time is charged to a step; within a node by default."""
        return _Spent(self, (step, node))

    def shares(self) -> tuple[Share, ...]:
        """Return what the tick has taken so far, the slowest step first."""
        self._charge()
        shares = (Share(*where, *took) for where, took in self._totals.items())
        return tuple(sorted(shares, key=lambda one: -one.took_s))

    def enter(self, where: tuple[str, str]) -> None:
        """Begin a step."""
        self._charge()
        self._within.append((where[0], where[1] or self._within[-1][1]))

    def leave(self) -> None:
        """End the step that was begun last."""
        self._charge()
        self._within.pop()

    def _charge(self) -> None:
        if not self._measures:
            return
        now = wall_s(), thread_s()
        took_s, computed_s = self._totals.get(self._within[-1], (0.0, 0.0))
        self._totals[self._within[-1]] = (
            took_s + now[0] - self._marks[0],
            computed_s + now[1] - self._marks[1],
        )
        self._marks = now


class _Spent:
    """A step of a tick, as a context."""

    __slots__ = ("_times", "_where")

    def __init__(self, times: TickTimes, where: tuple[str, str]) -> None:
        self._times = times
        self._where = where

    def __enter__(self) -> Self:
        self._times.enter(self._where)
        return self

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _traceback: TracebackType | None,
    ) -> None:
        self._times.leave()


def step_of(verb: Callable[..., Any]) -> str:
    """Return `capability.verb` of a plugin's method."""
    capability = getattr(getattr(verb, "__self__", None), "capability", "")
    return f"{capability}.{verb.__name__}" if capability else verb.__name__
