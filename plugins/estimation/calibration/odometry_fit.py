"""Mounting and clock of a sensor whose odometry is laid beside a known motion (hand-eye)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.estimation.calibration.motion_track import MotionTrack
from scipy.spatial.transform import Rotation

from executive.arrays import Float
from executive.messages.odometry import LidarIncrement

TURN, ARM, LATE, SCALE, BEND = slice(0, 3), slice(3, 6), 6, 7, slice(8, 11)
_UNKNOWNS = 11
_SCALE_STD = 0.1  # of the lengths that odometry measures: drift is a few per cent
_BEND_STD_RAD_M = 0.01  # turning with the distance, which is drift too
_COARSE_S = 0.02  # between the first guesses of the clock
_LEAST = 30  # increments
_HUBER = 1.345  # residuals beyond it count linearly: 95 % efficient for those of a Gaussian
_ITERATIONS = 50
_SETTLED = 1e-4  # step over the prior deviation that ends the search
_SMALL, _SHORT_S = 1e-5, 2e-3  # steps of derivatives [rad], [m] or none, and of that by the clock
# Reach of an instrument: the noise of samples in it falls with its power of 1.5, and of a motion of
# 2 Hz, a pedestrian's, it keeps half.
_REACH_S = 0.15
_BLOCK_S = 3.0  # over which errors may be alike: the motion's, between corrections by fixes


@dataclass(frozen=True, slots=True, eq=False)
class OdometryFit:
    """What increments say of the sensor that measured them.

    Attributes:
        T_imu_sensor: Its mounting, shape (4, 4).
        late_s: Stamps minus times of measurement [s].
        covariance: Of the mounting's rotation (in the sensor's axes) and position (in the IMU's),
            the clock, the scale of lengths and the turning per metre, shape (11, 11).
        misfit: Squared residuals over what the declared covariance of increments explains.
        free: How many residuals are left over by the unknowns.
    """

    T_imu_sensor: Float
    late_s: float
    covariance: Float
    misfit: float
    free: int


class OdometryProblem:
    """Residuals of increments for a mounting, a clock, and a drift with the distance."""

    def __init__(
        self,
        increments: Sequence[LidarIncrement],
        track: MotionTrack,
        T_imu_sensor: Float,
        stds: tuple[float, float, float],
    ) -> None:
        """Take the increments that the track covers whatever the clock is.

        Args:
            increments: Of one sensor.
            track: The motion of the IMU.
            T_imu_sensor: The declared mounting.
            stds: How far its rotation [rad], its position [m] and its clock [s] may be off.
        """
        begin_s, end_s = track.span_s
        self._limit_s = 2.0 * stds[2]
        margin_s = self._limit_s + _REACH_S
        kept = [
            one
            for one in increments
            if one.from_s > begin_s + margin_s and one.to_s < end_s - margin_s
        ]
        self.count = len(kept)
        self._track, self._T = track, T_imu_sensor
        self._prior_std = np.array(
            [stds[0]] * 3 + [stds[1]] * 3 + [stds[2], _SCALE_STD] + [_BEND_STD_RAD_M] * 3
        )
        self._from_s = np.array([one.from_s for one in kept])
        self._to_s = np.array([one.to_s for one in kept])
        measured = np.array([one.T_from_to for one in kept]).reshape(-1, 4, 4)
        self._turns, self._steps = measured[:, :3, :3], measured[:, :3, 3]
        roots = [np.linalg.cholesky(np.linalg.inv(one.covariance)).T for one in kept]
        self._roots = np.array(roots).reshape(-1, 6, 6)

    @property
    def is_enough(self) -> bool:
        """Whether there are increments enough to solve for the unknowns."""
        return self.count >= _LEAST

    def solved(self) -> OdometryFit | None:
        """Return the fit; None if the increments do not determine it."""
        count = round(self._limit_s / _COARSE_S)
        x = np.zeros(_UNKNOWNS)
        x[LATE] = min(_COARSE_S * np.arange(-count, count + 1), key=self._turning_misfit)
        for _ in range(_ITERATIONS):
            residuals = self._residuals(x)
            J, Z = self._slopes(x)
            Z *= _weights(residuals)[:, None]
            try:
                step = np.linalg.solve(Z.T @ J, Z.T @ residuals)
            except np.linalg.LinAlgError:
                return None
            x = x - step
            x[LATE] = np.clip(x[LATE], -self._limit_s, self._limit_s)
            if (np.abs(step) < _SETTLED * self._prior_std).all():
                return self._fit(x)
        return None

    def _fit(self, x: Float) -> OdometryFit | None:
        """Return the fit by the unknowns that were found; None if it tells no covariance."""
        residuals = self._residuals(x)
        free = 6 * self.count - _UNKNOWNS
        misfit = float(np.sum(_counted(residuals))) / free
        covariance = self._covariance(*self._slopes(x), residuals, misfit)
        if not np.isfinite(covariance).all():
            return None
        T = self._T.copy()
        T[:3, :3] = T[:3, :3] @ Rotation.from_rotvec(x[TURN]).as_matrix()
        T[:3, 3] += x[ARM]
        return OdometryFit(T, float(x[LATE]), covariance, misfit, free)

    def _slopes(self, x: Float) -> tuple[Float, Float]:
        """Return the derivatives of the residuals, and instruments, shapes (6 n + 11, 11) each.

        The derivative by the clock is as noisy as single samples. What least squares make of that
        is too small a variance and an estimate that clings to the first guess, for noise in a
        derivative counts as motion. Instruments are free of it: differences over a longer time,
        which need not be derivatives (instrumental variables, Söderström and Stoica 1983).
        """
        steps = np.where(np.arange(_UNKNOWNS) == LATE, _SHORT_S, _SMALL)
        J = np.column_stack([self._difference(x, i, step) for i, step in enumerate(steps)])
        Z = J.copy()
        Z[:, LATE] = self._difference(x, LATE, _REACH_S)
        return J, Z

    def _difference(self, x: Float, index: int, step: float) -> Float:
        """Return the mean derivative by an unknown from a step below a value to one above."""
        ahead = np.zeros(_UNKNOWNS)
        ahead[index] = step
        return (self._residuals(x + ahead) - self._residuals(x - ahead)) / (2.0 * step)

    def _covariance(self, J: Float, Z: Float, residuals: Float, misfit: float) -> Float:
        """Return the covariance of the unknowns, also if errors of neighbours are alike.

        The motion itself errs, and odometry drifts, for seconds. The sums of gradients over blocks
        of time are independent, those of increments are not (the cluster-robust sandwich of Liang
        and Zeger 1986); where that is less certain than independent errors, it holds.

        Args:
            J, Z: See `_slopes`.
            residuals: Of the solution, shape (6 n + 11,).
            misfit: See `OdometryFit`.
        """
        inverse_ = np.linalg.inv(Z.T @ J)
        plain = max(misfit, 1.0) * inverse_ @ (Z.T @ Z) @ inverse_.T
        blocks = ((self._from_s - self._from_s[0]) // _BLOCK_S).astype(int)
        count = int(blocks[-1]) + 1
        pulls = np.zeros((count, _UNKNOWNS))
        each = (Z[:-_UNKNOWNS] * residuals[:-_UNKNOWNS, None]).reshape(-1, 6, _UNKNOWNS).sum(axis=1)
        np.add.at(pulls, blocks, each)
        robust = inverse_ @ (pulls.T @ pulls) @ inverse_.T * count / max(count - _UNKNOWNS, 1)
        grown = np.sqrt(np.maximum(np.diag(robust) / np.diag(plain), 1.0))
        return np.asarray(plain * np.outer(grown, grown))

    def _turning_misfit(self, late_s: float) -> float:
        """Return how far the angles differ, which no mounting changes, for a clock's offset [s]."""
        turned, _ = self._moved(late_s)
        angles = Rotation.from_matrix(self._turns).magnitude()
        return float(np.abs(turned.magnitude() - angles).sum())

    def _moved(self, late_s: float) -> tuple[Rotation, Float]:
        """Return the motion of the IMU over each increment, in its axes at the beginning."""
        R0, p0 = self._track.at(self._from_s - late_s)
        R1, p1 = self._track.at(self._to_s - late_s)
        return R0.inv() * R1, R0.inv().apply(p1 - p0)

    def _residuals(self, x: Float) -> Float:
        R_imu_sensor = Rotation.from_matrix(self._T[:3, :3]) * Rotation.from_rotvec(x[TURN])
        arm = self._T[:3, 3] + x[ARM]
        turned, moved = self._moved(float(x[LATE]))
        turn = R_imu_sensor.inv() * turned * R_imu_sensor
        bend = Rotation.from_rotvec(np.linalg.norm(self._steps, axis=1)[:, None] * x[BEND])
        step = R_imu_sensor.inv().apply(moved + turned.apply(arm) - arm)
        off = np.column_stack(
            [
                ((turn * bend).inv() * Rotation.from_matrix(self._turns)).as_rotvec(),
                self._steps - (1.0 + x[SCALE]) * step,
            ]
        )
        weighted = np.einsum("nij,nj->ni", self._roots, off).ravel()
        return np.concatenate([weighted, x / self._prior_std])


def _weights(residuals: Float) -> Float:
    """Return by what a residual is multiplied where it counts linearly, shape (n,)."""
    return np.asarray(np.minimum(1.0, _HUBER / np.maximum(np.abs(residuals), _HUBER)))


def _counted(residuals: Float) -> Float:
    """Return squares of residuals, which grow linearly beyond the bound of Huber, shape (n,)."""
    size = np.abs(residuals)
    return np.where(size <= _HUBER, size**2, _HUBER * (2.0 * size - _HUBER))
