"""A motion of a given length, and a step that looks on."""

from collections.abc import Callable, Generator
from typing import Any

from executive.leaf.outcome import Outcome, succeeded

TICK_S = 0.05
Motion = Generator[None, None, Outcome[None]]


def outcome_of(
    context: Any, lasts_s: float, looking_on: Callable[[Motion], Motion]
) -> tuple[Outcome[None], float, bool]:
    """Return how a motion ended, when by `time_s`, and whether the arm was stopped."""
    stopped = []

    def moving() -> Motion:
        try:
            while context.time_s < lasts_s:
                yield None
        except GeneratorExit:
            stopped.append(context.time_s)
            raise
        return succeeded()

    steps = looking_on(moving())
    while True:
        try:
            next(steps)
        except StopIteration as ended:
            return ended.value, context.time_s, bool(stopped)
        context.time_s += TICK_S
