"""Drive the jaws until they are at rest: the step that opening and closing share."""

from collections.abc import Callable, Generator

from executive.interfaces.robot import Robot
from executive.leaf.context import Context
from executive.messages.command import MoveJaws

# moving less than this in the window below counts as rest; encoder noise is below 1 mrad
_STILL_RAD = 0.01
_WINDOW_S = 0.5


def drive_jaws(
    context: Context,
    position_rad: float,
    force_n: float | None,
    must_stop: Callable[[], bool] = lambda: False,
    must_wait: Callable[[], bool] = lambda: False,
) -> Generator[None, None, float]:
    """Command the jaws, wait until they are at rest, and return their angle [rad].

    They stop where they are once `must_stop` tells so, and wait there for as long as `must_wait`
    does; both are asked at each tick, in this order.
    """
    force_n = context.machine().gripper.tip_force_n if force_n is None else force_n
    context.use(Robot).command(MoveJaws(position_rad, force_n))
    jaw, waits = context.machine().jaw.name, False
    before, before_s = context.joints().of(jaw)[0], context.now_s()
    while True:
        yield None
        now = context.joints().of(jaw)[0]
        if must_stop():
            return (yield from drive_jaws(context, now, force_n))
        if must_wait() is not waits:
            waits = not waits
            context.use(Robot).command(MoveJaws(now if waits else position_rad, force_n))
            before, before_s = now, context.now_s()
        if waits or context.now_s() - before_s < _WINDOW_S:
            continue
        if abs(now - before) < _STILL_RAD:
            return now
        before, before_s = now, context.now_s()
