"""How quickly a machine on supports that yield may move its arm, empty or with a stone."""

from collections.abc import Callable

import numpy as np

from executive.arrays import Float
from executive.machine.sway import Sway
from executive.machine.swayed import swayed
from executive.machine.tipping_moment import SHARE, MotionMoments, TippingMoment
from executive.messages.trajectory import JointTrajectory

_EMPTY = 1.5  # times the share of a load


class Easing:
    """Motions that use a part of what holds the machine on its supports, with the sway they make.

    It is `SHARE` with a load, as a sway from before may use as much, and half as much more without,
    as an empty arm begins at rest. Joints that accelerate together add up at the tool; the limits
    of each joint alone know nothing of that. An arm that went down at 7 m and braked used 0.5 of
    what holds the machine, and tipped it by the sway of that. The sway is that of a machine on all
    of its supports, which the model has at 0.9 where those that come off the ground have tipped it.

    Args:
        moment: What holds the machine.
        sway: The sway of the machine.
        mass_kg: The most that hangs in the jaws; 0 without a load.
    """

    def __init__(self, moment: TippingMoment, sway: Sway, mass_kg: float) -> None:
        self._moment, self._sway, self._mass_kg = moment, sway, mass_kg
        self._most = SHARE if mass_kg else _EMPTY * SHARE

    def eased(self, timed: Callable[[float], JointTrajectory]) -> JointTrajectory:
        """Return a motion that the machine bears.

        Args:
            timed: Returns the motion, given the share of its accelerations that it may use.
        """
        motion = timed(1.0)
        over = self._over(motion)
        if over <= 1.0:
            return motion
        motion = timed(1.0 / over)
        over = self._over(motion)
        return motion.slowed(over**0.5) if over > 1.0 else motion

    def _over(self, motion: JointTrajectory) -> float:
        """Return the share of what it may use that a motion of all joints uses."""
        moments = self._moment.along(motion.times_s, motion.position, self._mass_kg)
        ends = motion.position[0], motion.position[-1]
        return max(self._used(moments, q) for q in ends) / self._most

    def _used(self, moments: MotionMoments, q: Float) -> float:
        """Return the largest share of what holds the machine that presses, as it sways at q."""
        period_s = self._sway.period_s(q, self._mass_kg)
        pressing_nm = swayed(moments.tipping_nm, moments.step_s, period_s)
        rest = len(pressing_nm) - len(moments.holding_nm)
        holding_nm = np.pad(moments.holding_nm, ((0, rest), (0, 0)), "edge")
        return float((pressing_nm / holding_nm).max())
