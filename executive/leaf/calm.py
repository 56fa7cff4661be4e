"""Wait until a machine that sways under a load sways so little that it may move on."""

from collections import deque
from collections.abc import Generator

import numpy as np

from executive.arrays import Float
from executive.leaf.context import Context
from executive.machine.stance import SLOWEST_S


def calm(context: Context, mass_kg: float) -> Generator[None, None, None]:
    """Wait until the sway uses at most 0.4 of what holds the machine, 2.5 s at most.

    As much is for the motion that follows, and a fifth is left. How far the gripper goes up and
    down is seen at each tick, for half of the known period of the sway at least. The supports are
    springs, so that it tells what presses on them: the load, the arm and the chassis, which sway
    together. What is weighed in the jaws tells of the load alone, which was two fifths of what
    pressed. Nothing is waited for where nothing yields, or where twice the load would use no more
    than that: no load that comes on at once does more.

    Args:
        context: The leaf's view of the mission, with the arm at rest.
        mass_kg: What hangs in the jaws [kg].
    """
    machine, q, began_s = context.machine(), context.arm(), context.now_s()
    if machine.stance.support_n_m is None:
        return
    from executive.machine.sway import Sway  # reading a mission imports no kinematics
    from executive.machine.tipping_moment import SHARE, TippingMoment

    moment, sway = TippingMoment(machine), Sway(machine)
    period_s, kg_per_m = sway.period_s(q, mass_kg), mass_kg / sway.sink_m(q, mass_kg)
    least_nm = (1.0 - SHARE) * moment.holding_nm(q, mass_kg)
    seen: deque[tuple[float, float]] = deque()
    amplitude_kg = mass_kg
    while (moment.holding_nm(q, mass_kg + amplitude_kg) < least_nm).any():
        yield None
        now_s = context.now_s()
        if now_s - began_s >= SLOWEST_S:
            return
        seen.append((now_s, context.gripper()[2, 3]))
        while now_s - seen[0][0] > period_s:
            seen.popleft()
        if now_s - seen[0][0] >= period_s / 2:
            times_s, heights_m = np.array(seen).T
            amplitude_kg = kg_per_m * _amplitude(times_s, heights_m, period_s)


def _amplitude(times_s: Float, values: Float, period_s: float) -> float:
    """Return the amplitude of a sway of a period about an unknown level, by least squares."""
    phase = 2 * np.pi * (times_s - times_s[-1]) / period_s
    waves = np.column_stack([np.cos(phase), np.sin(phase), np.ones_like(phase)])
    return float(np.hypot(*np.linalg.lstsq(waves, values, rcond=None)[0][:2]))
