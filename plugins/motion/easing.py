"""How quickly a machine on supports that yield may move its arm, empty or with a stone."""

from collections.abc import Callable

from executive.machine.tipping_moment import SHARE, TippingMoment
from executive.messages.trajectory import JointTrajectory


class Easing:
    """Motions that use at most 0.4 of what holds the machine on its supports.

    Joints that accelerate together add up at the tool; the limits of each joint alone know nothing
    of that. An empty arm of some tonnes that brakes at 7 m needs it as well: one took 0.66 of what
    holds the machine, sway and all.

    Args:
        moment: What holds the machine.
        mass_kg: The most that hangs in the jaws.
    """

    def __init__(self, moment: TippingMoment, mass_kg: float) -> None:
        self._moment, self._mass_kg = moment, mass_kg

    def eased(self, timed: Callable[[float], JointTrajectory]) -> JointTrajectory:
        """Return a motion that the machine bears.

        Where the load at rest is beyond what the machine holds, whoever carries it judges that, and
        the motion stays as it is.

        Args:
            timed: Returns the motion, given the share of its accelerations that it may use.
        """
        motion = timed(1.0)
        over = self._over(motion)
        if not 1.0 < over < float("inf"):
            return motion
        motion = timed(1.0 / over)
        over = self._over(motion)
        return motion.slowed(over**0.5) if 1.0 < over < float("inf") else motion

    def _over(self, motion: JointTrajectory) -> float:
        """Return the share of what it may use that a motion of all joints uses."""
        path = (motion.times_s, motion.position, motion.velocity)
        return self._moment.used(*path, self._mass_kg) / SHARE
