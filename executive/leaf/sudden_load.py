"""Whether what comes to hang in jaws that close comes on faster than the machine can bear it."""

from collections import deque

import numpy as np

from executive.arrays import Float
from executive.leaf.context import Context
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.stance import LEFT, SLOWEST_S

# Looks by which a growing load is told ahead: efforts are averaged, and jaws stop a tick later.
_AHEAD = 2
_LONGEST_S = 2 * SLOWEST_S  # of all waits for one stone: what does not settle then tips it at rest


class SuddenLoad:
    """A load that jaws lift as they close, and the sway that it makes.

    Jaws that meet below a stone lift it within a fifth of a second. A load that comes on faster
    than the machine sways makes it sway about the new level, by as much as the load has changed
    within the last sway. It is too sudden while that leaves less than a tenth of what holds the
    machine: jaws that wait meanwhile take the load on in steps.

    Args:
        context: The leaf's view of the mission. Where no support yields nothing sways.

    Attributes:
        waited_s: For how long it has been too sudden [s].
    """

    def __init__(self, context: Context) -> None:
        from executive.machine.sway import Sway  # these import kinematics
        from executive.machine.tipping_moment import TippingMoment

        machine, self.waited_s = context.machine(), 0.0
        yields = machine.stance.supports_m and machine.stance.support_n_m is not None
        self._moment = TippingMoment(machine) if yields else None
        self._sway = Sway(machine)
        self._seen = deque[tuple[float, Float]]()  # the shares of the last sway, and their times

    def is_too_sudden(self, now_s: float, q: Float, force_n: Float) -> bool:
        """Look at the force on the tool, once a tick.

        Args:
            now_s: The time [s].
            q: Positions of the arm's joints [rad] or [m], shape (n,).
            force_n: The force on the tool beyond what hung in the jaws before they moved, in axes
                of the base [N], shape (3,).
        """
        if self._moment is None:
            return False
        share = self._moment.tipping_nm(q, force_n) / self._moment.holding_nm(q, 0.0)
        if force_n[2] > 0.0:  # a thrust of what lies below, for which the gripper is raised
            share = np.zeros_like(share)
        self._seen.append((now_s, share))
        while now_s - self._seen[0][0] > SLOWEST_S:
            self._seen.popleft()
        if len(self._seen) < 2 or self.waited_s >= _LONGEST_S:
            return False
        before_s, before = self._seen[-2]
        ahead = share + _AHEAD * np.maximum(share - before, 0.0)
        # The mean is at least the least share, or none: the period of the sway is seldom asked for.
        least = np.minimum(np.min([one for _, one in self._seen], axis=0), 0.0)
        if not self._is_much(ahead, least):
            return False
        period_s = self._sway.period_s(q, max(-force_n[2], 0.0) / GRAVITY_M_S2)
        if not self._is_much(ahead, self._summed(now_s - period_s) / period_s):
            return False
        self.waited_s += now_s - before_s
        return True

    def _summed(self, since_s: float) -> Float:
        """Return the shares since a time, times how long they lasted [s], shape (K,)."""
        late = [one for one in self._seen if one[0] >= since_s]
        times_s, shares = np.array([at_s for at_s, _ in late]), np.array([one for _, one in late])
        return np.asarray(np.diff(times_s) @ shares[1:])

    @staticmethod
    def _is_much(ahead: Float, mean: Float) -> bool:
        """Return whether a load tips the machine, which sways about the mean of the last sway."""
        return bool((2 * ahead - mean > 1.0 - LEFT).any())
