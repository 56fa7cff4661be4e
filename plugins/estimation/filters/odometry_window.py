"""The motion over some seconds, by a filter and by odometry that it does not use."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from executive_plugins.estimation.cholesky import squared_distance
from executive_plugins.estimation.gate.likely_error import likely_error
from executive_plugins.estimation.inertial.exponential import linear_covariance
from executive_plugins.estimation.inertial.state import POSITION, ROTATION, VELOCITY
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.live.packing import unpacked

from executive.arrays import Float
from executive.geometry.rotation import log_so3, skew
from executive.messages.odometry import LidarIncrement

_POSE = np.ix_(*2 * (np.r_[ROTATION, POSITION],))
TURN, WAY = _PARTS = slice(0, 3), slice(3, 6)  # of what differs


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """A filter at the end of an increment, with what odometry has measured up to then.

    Attributes:
        stamp_s: The time [s].
        R, p: Of the IMU in the map [m].
        covariance: Of rotation and position, map axes, shape (6, 6).
        velocity2: Covariance of the velocity, map axes, shape (3, 3).
        apart: Sum of the turns and ways by which the filter moved otherwise than odometry, map axes
            [rad, m], shape (6,).
        noise: Sum of the increments' covariances, map axes, shape (6, 6).
        way: Sum of the ways by odometry, map axes [m], shape (3,).
        length_m: Length of that way.
    """

    stamp_s: float
    R: Float
    p: Float
    covariance: Float
    velocity2: Float
    apart: Float
    noise: Float
    way: Float
    length_m: float

    @classmethod
    def at(cls, block: Block) -> "Look":
        """Return a filter before the first increment; its row has shape (1,), dtype `FILTER`."""
        state, covariance = unpacked(block)
        R, p = state.R_map_imu, state.p_map_imu
        P = linear_covariance(state, covariance)
        pose = P[_POSE]
        pose[TURN, TURN] = R @ pose[TURN, TURN] @ R.T
        sums = np.zeros(6), np.zeros((6, 6)), np.zeros(3), 0.0
        return cls(state.sample.stamp_s, R, p, pose, P[VELOCITY, VELOCITY], *sums)

    def after(self, block: Block, increment: LidarIncrement) -> "Look":
        """Return a filter at the end of an increment of the IMU that begins here."""
        now, T = Look.at(block), increment.T_from_to
        R, step = self.R @ T[:3, :3], self.R @ T[:3, 3]  # of odometry
        apart = np.concatenate([now.R @ log_so3(R.T @ now.R), now.p - self.p - step])
        axes = np.zeros((6, 6))
        axes[TURN, TURN] = axes[WAY, WAY] = R
        noise = self.noise + axes @ increment.covariance @ axes.T
        length_m = self.length_m + float(np.linalg.norm(step))
        sums = self.apart + apart, noise, self.way + step, length_m
        return Look(now.stamp_s, now.R, now.p, now.covariance, now.velocity2, *sums)


@dataclass(frozen=True, eq=False)
class OdometryWindow:
    """What differs between two looks.

    Attributes:
        begin, end: The looks.
        drift: Standard deviation of what odometry errs all along, as a share of the way; a heading
            that errs by that moves the end by as much.
    """

    begin: Look
    end: Look
    drift: float

    @cached_property
    def apart(self) -> Float:
        """Turn and way of the filter less those of odometry, map axes [rad, m], shape (6,)."""
        return np.asarray(self.end.apart - self.begin.apart)

    @property
    def length_m(self) -> float:
        """Length of the way [m]."""
        return self.end.length_m - self.begin.length_m

    @property
    def lasts_s(self) -> float:
        """Time between the two looks [s]."""
        return self.end.stamp_s - self.begin.stamp_s

    @cached_property
    def noise(self) -> Float:
        """Covariance of what differs without the drift, shape (6, 6).

        The attitude's error turns all of the way, and is nearly the same along it.
        """
        begin, end = self.begin, self.end
        answer = begin.covariance + end.covariance + end.noise - begin.noise
        by_attitude = skew(end.way - begin.way)
        answer[WAY, WAY] += by_attitude @ begin.covariance[TURN, TURN] @ by_attitude.T
        return np.asarray(answer)

    def covariance(self, part: slice) -> Float:
        """Return the covariance of the turn or of the way that differs, shape (3, 3)."""
        drift = self.drift if part == TURN else self.drift * self.length_m
        return np.asarray(self.noise[part, part] + drift**2 * np.eye(3))

    @cached_property
    def _distances2(self) -> tuple[float, float]:
        """Squared distances of both turns, and of both ways."""
        turn, way = (squared_distance(self.covariance(part), self.apart[part]) for part in _PARTS)
        return turn, way

    def distance2(self, part: slice) -> float:
        """Return the squared distance of both turns or ways."""
        return self._distances2[_PARTS.index(part)]

    def second_moment(self, part: slice) -> Float:
        """Return that of the filter's error if odometry is right, shape (3, 3)."""
        return np.asarray(np.outer(self.apart[part], self.apart[part]) + self.covariance(part))

    def likely_error(self, part: slice) -> Float:
        """Return the second moment of the filter's error, over whether it errs at all, (3, 3).

        Args:
            part: `TURN` or `WAY`.
        """
        return likely_error(self.apart[part], self.covariance(part), self.lasts_s)

    def carried_distance2(self) -> float:
        """Return the squared distance of both ways by what inertial samples tell of them.

        They carry the velocity of the begin on, with its error. This holds for a second or two.
        """
        carried = self.lasts_s**2 * self.begin.velocity2
        return squared_distance(self.covariance(WAY) + carried, self.apart[WAY])
