"""Lower what was lifted too far back to where it stood: the step after a lift that was stopped."""

from collections.abc import Generator

import numpy as np

from executive.arrays import Float
from executive.leaf.context import Context
from executive.leaf.follow import follow
from executive.leaf.outcome import Outcome
from executive.leaf.steady_line import steady_line
from executive.leaf.tool_way import tool_way
from executive.leaf.watched import watched
from executive.messages.trajectory import JointTrajectory

_SPEED_M_S, _RAMP_S = 0.05, 0.4  # as slowly as `LowerUntilDown` seeks the ground


def way_back(context: Context, postured: Float) -> Generator[None, None, Outcome[None]]:
    """Lower what hangs in the jaws until the ground carries it, at most to where the arm was.

    The joints go back along a straight line: over the height of a trial lift it is one of the tool,
    too, and on supports that yield it ends with as much on them as before the lift, where a way
    in the map would end too high by what they have risen. The line is the same as the way up, so it
    is not checked for obstacles.

    Args:
        context: The leaf's view of the mission, with the arm at rest.
        postured: Positions of the arm's joints before the lift [rad] or [m], shape (n,).
    """
    machine, ends = context.machine(), np.stack([context.arm(), postured])
    names, still = machine.arm_names, np.zeros_like(ends)
    line = JointTrajectory(names, np.array([0.0, 1.0]), ends, still)
    slow = steady_line(line, tool_way(machine, line), _SPEED_M_S, _RAMP_S)

    def hangs() -> bool:
        mass_kg = context.payload_kg()
        return mass_kg is None or mass_kg > 0.0

    return (yield from watched(follow(context, slow), hangs))
