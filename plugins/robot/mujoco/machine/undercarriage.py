"""The machine that raises its legs to drive, and stands on them where it works.

Legs and wheels bear it one after the other. While it drives, the carrier of its wheels holds the
chassis, as that of a machine on wheels alone (`wheels.py`); where it stands, its legs alone do.
"""

from enum import StrEnum
from typing import TypedDict

import numpy as np
from executive_plugins.robot.base_driver import KeptBase
from executive_plugins.robot.mujoco.machine.legs import Legs
from executive_plugins.robot.mujoco.machine.wheels import Wheels
from executive_plugins.robot.mujoco.physics_settings import LegSettings

from executive.arrays import Float
from executive.errors import RobotError
from executive.geometry.pose import interpolate, pose
from executive.geometry.rotation import about_axis, yaw_of
from executive.machine.machine import Machine
from executive.messages.command import Drive

_WAITS_S = 0.3  # on its wheels, after it has braked, before it stands on its legs
_FASTEST = 1.5  # largest speed of the chassis on the way between wheels and legs over its mean
_SETTLES_S = 1.0  # on its legs, before the arm may move: two of its slowest sways without a load


class Phase(StrEnum):
    """What bears the machine, or is about to."""

    STANDS = "stands on its legs"
    RAISES = "raises its legs"
    ROLLS = "is on its wheels"
    LOWERS = "puts its legs down"
    SETTLES = "settles on its legs"


class KeptUndercarriage(TypedDict):
    """Where the legs are, what moves, and from where to where the chassis goes."""

    legs: Float
    wheels: KeptBase
    phase: str
    since_s: float
    lasts_s: float
    begin: Float
    end: Float
    is_frozen: bool


class Undercarriage:
    """Wheels and legs of one machine.

    The first command to drive lets the wheels bear the machine, and raises the legs; commands count
    from then on. A machine that has braked, and that no command drives on, puts its legs down until
    each bears its part, and levels the chassis meanwhile. Then the wheels let go.

    Attributes:
        wheels: Its wheels.
    """

    def __init__(self, machine: Machine, legs: Legs, wheels: Wheels, settings: LegSettings) -> None:
        self.wheels, self._legs, self._machine = wheels, legs, machine
        self._speed_m_s, self._longest_s = settings.speed_m_s, settings.longest_s
        self._clearance_m = settings.clearance_m
        self._phase, self._since_s, self._lasts_s = Phase.STANDS, 0.0, 0.0
        self._begin = self._end = np.eye(4)
        self._is_frozen = False

    @property
    def is_moving(self) -> bool:
        """Whether the chassis or a leg moves."""
        return self._phase is not Phase.STANDS and not (
            self._is_frozen and not self.wheels.driver.is_moving
        )

    @property
    def stands(self) -> bool:
        """Whether the legs alone bear the machine, and nothing moves them."""
        return self._phase is Phase.STANDS

    def command(self, drive: Drive, arm: Float, *, arm_moves: bool) -> None:
        """Drive, once the legs are raised; see `BaseDriver.command`."""
        self._is_frozen = False
        if self._phase is Phase.ROLLS:
            self.wheels.driver.command(drive, arm, arm_moves=arm_moves)
        elif drive.speed_m_s == 0.0:
            self._stand_again()
        else:
            self.wheels.driver.check(drive, arm, arm_moves=arm_moves)
            if self._phase is not Phase.RAISES:
                self._raise()

    def check_standing(self) -> None:
        """Let a motion of the arm pass only while the machine stands.

        Raises:
            RobotError: If it drives, or its legs are not down.
        """
        self.wheels.driver.check_at_rest()
        if self._phase is not Phase.STANDS:
            raise RobotError(
                f"the machine {self._phase}: the arm moves when it stands on them, within "
                f"{self._longest_s:.0f} s after it has braked"
            )

    def stop(self) -> None:
        """Brake, and stand on the legs."""
        self.wheels.driver.stop()
        self._stand_again()

    def give_up(self) -> None:
        """Brake, and let all legs stay where they are until `go_on` or the next command."""
        self.wheels.driver.stop()
        self._is_frozen = True

    def go_on(self) -> None:
        """Go on after `give_up`: stand on the legs."""
        self._is_frozen = False

    def advance(self, dt_s: float) -> None:
        """Advance by one integration step; call it before the step.

        Raises:
            RobotError: If a leg finds no ground to stand on.
        """
        if self._phase is Phase.STANDS:
            return
        self.wheels.advance(dt_s)
        if self._is_frozen:
            return
        self._since_s += dt_s
        match self._phase:
            case Phase.RAISES:
                self._raise_on(dt_s)
            case Phase.ROLLS:
                self._roll_on()
            case Phase.LOWERS:
                self._lower_on(dt_s)
            case _ if self._since_s >= _SETTLES_S:
                self._enter(Phase.STANDS)

    def keep(self) -> KeptUndercarriage:
        """Return the state: a resumed machine goes on as it was."""
        return {
            "legs": self._legs.springs_m(),
            "wheels": self.wheels.driver.keep(),
            "phase": str(self._phase),
            "since_s": self._since_s,
            "lasts_s": self._lasts_s,
            "begin": self._begin,
            "end": self._end,
            "is_frozen": self._is_frozen,
        }

    def restore(self, kept: KeptUndercarriage) -> None:
        """Take back what `keep` returned."""
        self._legs.set_springs(np.array(kept["legs"]))
        self.wheels.driver.restore(kept["wheels"])
        self._phase, self._is_frozen = Phase(kept["phase"]), kept["is_frozen"]
        self._since_s, self._lasts_s = kept["since_s"], kept["lasts_s"]
        self._begin, self._end = np.array(kept["begin"]), np.array(kept["end"])

    def _enter(self, phase: Phase, lasts_s: float = 0.0) -> None:
        self._phase, self._since_s, self._lasts_s = phase, 0.0, lasts_s

    def _raise(self) -> None:
        """Hold the chassis where it is, and begin to set it on its wheels."""
        T = self.wheels.hold()
        place = np.array([T[0, 3], T[1, 3], yaw_of(T[:3, :3])])
        self.wheels.driver.pose_map = place
        self._go(Phase.RAISES, self.wheels.standing_at(place))

    def _raise_on(self, dt_s: float) -> None:
        are_up = self._legs.shorten(self._clearance_m, self._speed_m_s * dt_s)
        self._carry()
        if are_up and self._since_s >= self._lasts_s:
            self._enter(Phase.ROLLS)

    def _roll_on(self) -> None:
        if self.wheels.driver.is_moving:
            self._since_s = 0.0
        elif self._since_s >= _WAITS_S:
            self._lower()

    def _lower_on(self, dt_s: float) -> None:
        self._carry()
        bear = self._legs.lengthen(self._speed_m_s * dt_s)
        if bear and self._since_s >= self._lasts_s:
            self.wheels.let_go()
            self._enter(Phase.SETTLES)
        elif self._since_s > self._longest_s:
            raise RobotError(
                f"a leg has found no ground within {self._since_s:.0f} s: the machine cannot stand "
                "here"
            )

    def _stand_again(self) -> None:
        if self._phase is Phase.RAISES:
            self._lower()

    def _lower(self) -> None:
        """Begin to level the chassis, and to put the legs down."""
        T = self.wheels.carrier()
        R_level = about_axis(np.array([0.0, 0.0, 1.0]), yaw_of(T[:3, :3]))
        self._go(Phase.LOWERS, pose(R_level, T[:3, 3]))

    def _go(self, phase: Phase, end: Float) -> None:
        """Begin to move the chassis to a pose, no support faster than a leg moves."""
        self._begin, self._end = self.wheels.carrier(), end
        supports = np.array(self._machine.stance.supports_m)
        corners = np.c_[supports, np.full(len(supports), -self._machine.stance.base_height_m)]
        ways_m = corners @ (end - self._begin)[:3, :3].T + (end - self._begin)[:3, 3]
        farthest_m = max(float(np.linalg.norm(ways_m, axis=1).max()), self._clearance_m)
        self._enter(phase, _FASTEST * farthest_m / self._speed_m_s)

    def _carry(self) -> None:
        """Move the chassis along its way, with a speed that begins and ends with zero."""
        u = min(self._since_s / self._lasts_s, 1.0)
        share = u * u * (3.0 - 2.0 * u)
        self.wheels.carry_to(interpolate(self._begin, self._end, share))
