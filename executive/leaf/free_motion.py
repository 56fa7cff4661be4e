"""Whether an arm that should move freely presses on something, or lifts something."""

from collections.abc import Generator

import numpy as np

from executive.interfaces.robot import Robot
from executive.leaf.context import Context
from executive.leaf.loaded_stop import stop_now_s
from executive.leaf.outcome import Outcome
from executive.leaf.own_motion import OwnMotion
from executive.leaf.watched import guarded
from executive.machine.gravity import GRAVITY_M_S2
from executive.messages.command import LimitStop
from executive.messages.trajectory import JointTrajectory

_TICKS = 2  # in a row, so that one sample that errs stops nothing
_OF_BEGIN = 1.1  # an arm that already presses at first may go on, as long as it presses no more


class FreeMotion:
    """Watches the force on the tool of an arm that holds no stone.

    A stone that lies otherwise than its model says is met at the speed of the approach, and may
    hang on an open jaw on the way up. By the efforts of the arm such a force is too much once it
    takes more than 0.4 of what holds the machine on its supports, which is as much as the motions
    of a load may use (`tipping_moment.SHARE`). Where no supports are known, or no monitor tells
    the force, it never is.

    What the motion itself tells by its accelerations does not count (`OwnMotion`).

    Args:
        context: The leaf's view of the mission; it needs robot.
        trajectory: What the arm is to follow.

    Attributes:
        lifts: Whether the motion was ended because something hangs on the jaws.
    """

    def __init__(self, context: Context, trajectory: JointTrajectory) -> None:
        from executive.machine.tipping_moment import SHARE, TippingMoment  # imports kinematics

        self._context, self._most = context, SHARE
        has_supports = bool(context.machine().stance.supports_m)
        self._moment = TippingMoment(context.machine()) if has_supports else None
        self._own = OwnMotion(context, trajectory) if has_supports else None
        self._begun: float | None = None
        self._over, self.lifts = 0, False

    def watched(
        self, moving: Generator[None, None, Outcome[None]]
    ) -> Generator[None, None, Outcome[None]]:
        """Go through a motion, and fail once the arm presses or lifts too much.

        Args:
            moving: The motion; it stops the arm when it is closed.
        """
        return (yield from guarded(moving, self._trouble))

    def _trouble(self) -> str:
        """Return what is wrong at this tick; empty if nothing is."""
        hangs_kg = self._context.payload_kg()
        if self._moment is None or self._own is None or hangs_kg is None:
            return ""
        hangs_kg = self._own.beyond(hangs_kg, self._context.now_s())
        q, force_n = self._context.arm(), np.array([0.0, 0.0, -GRAVITY_M_S2 * hangs_kg])
        used = self._moment.tipping_nm(q, force_n) / self._moment.holding_nm(q, 0.0)
        share = float(used.max())
        if self._begun is None:
            self._begun = share
        self._over = self._over + 1 if share > max(self._most, _OF_BEGIN * self._begun) else 0
        if self._over < _TICKS:
            return ""
        self.lifts = hangs_kg > 0.0
        if self.lifts:  # the arm was to stop as quickly as without a load
            self._context.use(Robot).command(LimitStop(stop_now_s(self._context, hangs_kg)))
        what = "something hangs on the jaws" if self.lifts else "the arm presses on something"
        weight = f"{abs(hangs_kg):.0f} kg by the efforts of its joints, {share:.2f} of what"
        return f"{what}, {weight} holds the machine, where the way should be free"
