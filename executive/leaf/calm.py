"""Wait until a machine that sways under a load sways so little that it may move on."""

from collections import deque
from collections.abc import Generator

import numpy as np

from executive.arrays import Float
from executive.leaf.context import Context
from executive.machine.stance import SLOWEST_S

_FEWEST = 5  # values, of which the two amplitudes of a sway are told


def calm(context: Context, mass_kg: float) -> Generator[None, None, None]:
    """Wait until the sway uses at most 0.45 of what holds the machine, 2.5 s at most.

    As much is for the motion that follows, and a tenth is left. What hangs in the jaws is weighed
    at each tick: it sways about its mass with a known period. Nothing is waited for where nothing
    yields, or where twice the load would use no more than that: no load that comes on at once does
    more.

    Args:
        context: The leaf's view of the mission, with the arm at rest.
        mass_kg: What hangs in the jaws [kg].
    """
    machine, q, began_s = context.machine(), context.arm(), context.now_s()
    if machine.stance.support_n_m is None:
        return
    from executive.machine.sway import Sway  # reading a mission imports no kinematics
    from executive.machine.tipping_moment import SHARE, TippingMoment

    moment, period_s = TippingMoment(machine), Sway(machine).period_s(q, mass_kg)
    least_nm = (1.0 - SHARE) * moment.holding_nm(q, mass_kg)
    seen: deque[tuple[float, float]] = deque()
    amplitude_kg = mass_kg
    while (moment.holding_nm(q, mass_kg + amplitude_kg) < least_nm).any():
        yield None
        now_s, weighed_kg = context.now_s(), context.payload_kg()
        if weighed_kg is None or now_s - began_s >= SLOWEST_S:
            return
        seen.append((now_s, weighed_kg - mass_kg))
        while now_s - seen[0][0] > period_s / 2:
            seen.popleft()
        if len(seen) >= _FEWEST:
            times_s, off_kg = np.array(seen).T
            amplitude_kg = _amplitude(times_s, off_kg, period_s)


def _amplitude(times_s: Float, values: Float, period_s: float) -> float:
    """Return the amplitude of a sway of a period about zero, by least squares."""
    phase = 2 * np.pi * (times_s - times_s[-1]) / period_s
    waves = np.column_stack([np.cos(phase), np.sin(phase)])
    return float(np.hypot(*np.linalg.lstsq(waves, values, rcond=None)[0]))
