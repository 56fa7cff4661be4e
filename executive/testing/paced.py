"""Reads of a machine that lives by its own clock, at the times that the kit names."""

import time
from collections.abc import Sequence

from executive.clock import wall_s
from executive.interfaces.robot import Robot
from executive.messages.observation import Observation


def pace(robot: Robot) -> None:
    """Let each `read` of a robot with its own clock wait until its machine time has come.

    A simulated robot advances its world to that time, so that the kit need not wait; a robot with
    its own clock has measured nothing yet. Machine time begins with the first `read`.
    """
    read = robot.read
    begun_s: float | None = None

    def read_on_time(until_s: float) -> Sequence[Observation]:
        nonlocal begun_s
        if begun_s is None:
            begun_s = wall_s()
        time.sleep(max(0.0, begun_s + until_s - wall_s()))  # noqa: TID251 - no tick waits
        return read(until_s)

    robot.read = read_on_time  # type: ignore[method-assign]
