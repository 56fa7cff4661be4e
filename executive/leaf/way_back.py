"""Lower what was lifted back to where it stood: the step after a lift that was stopped."""

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
_JOINTS = 0.1  # share of the joints' speeds: one may turn while the tool hardly moves


def way_back(context: Context, postures: Float) -> Generator[None, None, Outcome[None]]:
    """Lower what hangs in the jaws until the ground carries it, at most to where the arm was.

    On supports that yield a way of the joints ends with as much on them as before the lift, where
    one in the map would end too high by what they have risen. It is the way that the arm came, and
    is not checked for obstacles.

    Args:
        context: The leaf's view of the mission, with the arm at rest.
        postures: Positions of the arm's joints on the way back [rad] or [m], the last one where it
            was before, shape (m, n).
    """
    machine = context.machine()
    places = np.vstack([context.arm(), postures])
    stamps = np.arange(len(places), dtype=np.float64)
    fastest = np.tile(_JOINTS * machine.max_velocity, (len(places), 1))  # that the line may be
    line = JointTrajectory(machine.arm_names, stamps, places, fastest)
    slow = steady_line(line, tool_way(machine, line), _SPEED_M_S, _RAMP_S)

    def hangs() -> bool:
        mass_kg = context.payload_kg()
        return mass_kg is None or mass_kg > 0.0

    return (yield from watched(follow(context, slow), hangs))
