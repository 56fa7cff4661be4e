"""Look on while a motion goes on, and end it early: the step that leaves which feel share."""

from collections.abc import Callable, Generator

from executive.leaf.outcome import Outcome, failed, succeeded


def watched(
    motion: Generator[None, None, Outcome[None]], goes_on: Callable[[], bool]
) -> Generator[None, None, Outcome[None]]:
    """Go on with a motion tick by tick; end it as a cancelled one once it is to end.

    Args:
        motion: Steps of a motion, such as those of `follow`, which stops the arm when closed.
        goes_on: Called at each tick after the motion's own step; `False` ends the motion, which
            counts as a success.
    """
    early = succeeded(reason="ended early")
    return (yield from _ended(motion, lambda: None if goes_on() else early))


def guarded(
    motion: Generator[None, None, Outcome[None]], trouble: Callable[[], str]
) -> Generator[None, None, Outcome[None]]:
    """Go on with a motion tick by tick; end it, and fail, once something is wrong.

    Args:
        motion: As in `watched`.
        trouble: Called at each tick after the motion's own step; says what is wrong, or is empty.
    """
    return (yield from _ended(motion, lambda: failed(told) if (told := trouble()) else None))


def _ended(
    motion: Generator[None, None, Outcome[None]], end: Callable[[], Outcome[None] | None]
) -> Generator[None, None, Outcome[None]]:
    try:
        while True:
            try:
                next(motion)
            except StopIteration as ended:
                outcome: Outcome[None] = ended.value
                return outcome
            if (early := end()) is not None:
                return early
            yield None
    finally:
        motion.close()
