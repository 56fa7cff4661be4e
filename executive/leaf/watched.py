"""Look on while a motion goes on, and end it early: the step that leaves which feel share."""

from collections.abc import Callable, Generator

from executive.leaf.outcome import Outcome, succeeded


def watched(
    motion: Generator[None, None, Outcome[None]], goes_on: Callable[[], bool]
) -> Generator[None, None, Outcome[None]]:
    """Go on with a motion tick by tick; end it as a cancelled one once it is to end.

    Args:
        motion: Steps of a motion, such as those of `follow`, which stops the arm when closed.
        goes_on: Called at each tick after the motion's own step; `False` ends the motion, which
            counts as a success.
    """
    try:
        while True:
            try:
                next(motion)
            except StopIteration as end:
                outcome: Outcome[None] = end.value
                return outcome
            if not goes_on():
                return succeeded(reason="ended early")
            yield None
    finally:
        motion.close()
