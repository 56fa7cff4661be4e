"""The chassis below the cabin: its pose by the turn joint, and whether it is at rest."""

from collections import deque
from dataclasses import dataclass

import numpy as np
from executive_plugins.estimation.inertial.state import rotation_step
from executive_plugins.estimation.start.chassis_sway import ChassisSway
from executive_plugins.estimation.start.settings import StandstillSettings

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.machine.rig import Rig
from executive.messages.joints import JointSample


class TurnJoint:
    """The joint between chassis and cabin, at its newest sample.

    A machine without such a joint is one rigid body.

    Attributes:
        axis: Axis of the turn in cabin axes, shape (3,).
        T_joint_base: Chassis in the cabin at a joint angle of zero, shape (4, 4).
        stamp_s: Time of the newest sample [s]; −∞ before the first.
        position_rad, velocity_rad_s: Angle [rad] and rate [rad/s] of that sample; zero before the
            first.
    """

    def __init__(self, machine: Rig) -> None:
        self._name = machine.turn_joint
        self.T_joint_base, self.axis = np.eye(4), np.array([0.0, 0.0, 1.0])
        if machine.turn_joint is not None:
            joint = machine.joints[machine.arm_names.index(machine.turn_joint)]
            self.T_joint_base, self.axis = (
                inverse(joint.T_parent_joint),
                np.asarray(joint.axis, dtype=float),
            )
        self.stamp_s = -np.inf
        self.position_rad = 0.0
        self.velocity_rad_s = 0.0
        self.is_known = self._name is None  # otherwise from the first sample on

    @property
    def rate_cabin(self) -> Float:
        """Angular velocity of the cabin relative to the chassis [rad/s], cabin axes, shape (3,)."""
        return self.axis * self.velocity_rad_s

    def update(self, sample: JointSample) -> None:
        """Take one joint sample."""
        if self._name is None:
            return
        self.position_rad, self.velocity_rad_s, _ = sample.of(self._name)
        self.stamp_s, self.is_known = sample.stamp_s, True

    def T_cabin_base(self, stamp_s: float) -> Float:
        """Return the chassis in the cabin at a time near the newest sample's, shape (4, 4).

        The angle is extrapolated with the measured rate, by at most 0.1 s.
        """
        ahead_s = max(-0.1, min(0.1, stamp_s - self.stamp_s))
        angle_rad = self.position_rad + ahead_s * self.velocity_rad_s
        return np.asarray(pose(rotation_step(-angle_rad * self.axis)) @ self.T_joint_base)


@dataclass(frozen=True, slots=True, eq=False)
class ChassisRest:
    """A chassis at rest, on which the cabin may turn.

    Attributes:
        stamp_s: Time [s].
        rate_cabin: Angular velocity of the cabin on the chassis [rad/s], cabin axes, shape (3,).
        sway_rad_s: By how much the chassis turns as it sways [rad/s], beside what a chassis at rest
            usually does; a standard deviation.
        sway_m_s: The same of the velocity of the cabin's origin along an axis [m/s].
    """

    stamp_s: float
    rate_cabin: Float
    sway_rad_s: float = 0.0
    sway_m_s: float = 0.0


class StandstillDetector:
    """Detects whether the chassis is at rest, from half a second of its inertial samples."""

    _WINDOW = 50

    def __init__(self, settings: StandstillSettings, sway: ChassisSway | None = None) -> None:
        """Make one without samples.

        Args:
            settings: Spreads of a chassis at rest.
            sway: Tells how fast it turns then; None if it has no sensor of its own.
        """
        self._settings, self._sway = settings, sway
        self._window: deque[Float] = deque(maxlen=self._WINDOW)
        self._stamps_s: deque[float] = deque(maxlen=self._WINDOW)
        self._newest_s = -np.inf

    def add(self, stamp_s: float, rate: Float, force: Float) -> None:
        """Add one inertial sample of the chassis."""
        if stamp_s - self._newest_s > 0.1:
            self._window.clear()
            self._stamps_s.clear()
        self._newest_s = stamp_s
        self._stamps_s.append(stamp_s)
        self._window.append(np.concatenate([rate, force]))

    def is_at_rest(self, stamp_s: float) -> bool:
        """Return whether the chassis is at rest around a time and that shall be used."""
        return self._settings.is_used and self._is_quiet(stamp_s)

    def force(self, stamp_s: float) -> Float | None:
        """Return the mean specific force of a chassis at rest, sensor axes [m/s²], shape (3,).

        None if it is not at rest.
        """
        return np.mean(self._window, axis=0)[3:] if self._is_quiet(stamp_s) else None

    def sway(self, period_s: float) -> tuple[float, float]:
        """Return the sway of a chassis at rest, `sway_rad_s` and `sway_m_s` of `ChassisRest`.

        An even turn lasts as long as the samples that show it: what is said of it in that time is
        one piece of information, so that its variance counts as often as it is said.

        Args:
            period_s: Time from one question to the next [s].
        """
        if self._sway is None:
            return 0.0, 0.0
        mean = np.mean(self._window, axis=0)[:3]
        piece_s = self._newest_s - self._stamps_s[0]
        rate_rad_s = self._sway.rate_rad_s(mean, piece_s) * max(1.0, piece_s / period_s) ** 0.5
        self._sway.take(self._newest_s, mean, piece_s)
        return rate_rad_s, rate_rad_s * self._sway.height_m

    def _is_quiet(self, stamp_s: float) -> bool:
        if len(self._window) < self._WINDOW or abs(stamp_s - self._newest_s) > 0.1:
            return False
        spread = np.std(self._window, axis=0)
        is_quiet = spread[:3].max() < self._settings.max_rate_std_rad_s
        return bool(is_quiet and spread[3:].max() < self._settings.max_force_std_m_s2)
