"""Estimation by the cabin's inertial sensor, the satellite antennas and the turn joint."""

from collections.abc import Callable, Mapping

import numpy as np

from executive.arrays import Float
from executive.geometry.geodesy import enu_from_geodetic
from executive.geometry.pose import inverse
from executive.interfaces.estimation import Estimator
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.odometry import LidarIncrement
from plugins.estimation.cabin_report import CabinReport
from plugins.estimation.cabin_sensors import antennas_in_imu, cabin_imu
from plugins.estimation.chassis import StandingDetector, TurnJoint
from plugins.estimation.correction import Correction
from plugins.estimation.doorkeeper import Doorkeeper
from plugins.estimation.error_state_filter import ErrorStateFilter
from plugins.estimation.first_state import FirstState
from plugins.estimation.gnss_imu_head import TrailingFilter
from plugins.estimation.gnss_imu_settings import GnssImuSettings
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import Inertial, InertialState
from plugins.estimation.measurement_models import antenna_residual, rate_residual, standing_residual
from robot_models.rig import Rig

INITIALISING, GLOBAL, FALLBACK = "INITIALISING", "GLOBAL", "FALLBACK"
_JUMP_S = 2.0  # an inertial stamp so far ahead is believed if the next one agrees; less is a gap, and bridged
_MAX_RATE_RAD_S = 35.0  # 2000 deg/s: the range of a MEMS sensor
_MAX_FORCE_M_S2 = 160.0  # 16 g
_STANDING_PERIOD_S = 0.1
_DOUBT_S = 2.0  # time after which a chassis that was seen to move may be taken to stand


class GnssImuFilter(Estimator):
    """An error-state Kalman filter on the cabin; heading comes with the antennas' lever arms.

    With one antenna it begins after the first metres of motion, and heading is known as far as the body accelerates.

    The role of the paper's baseline, the two-state implicit filter: inertial and satellite measurements only (Nubert
    2022, Sec. V). The filter itself trails by `lag_s`, so that measurements of whatever latency are used at their own
    time and in order; the state at the newest inertial sample is predicted from it.
    """

    Settings = GnssImuSettings

    def __init__(self, settings: GnssImuSettings, machine: Rig) -> None:
        self._settings = settings
        self._machine = machine

    def start(self) -> None:
        settings = self._settings
        imu = cabin_imu(self._machine, settings.imu)
        self._noise = InertialNoise.of(imu, settings.noise_factor, settings.gravity_m_s2)
        self._T_imu_cabin = inverse(imu.T_link_sensor)
        self._antennas_imu = antennas_in_imu(self._machine, imu)
        self._door = Doorkeeper()
        self._turn = TurnJoint(self._machine)
        self._standing = StandingDetector(settings.standing)
        self._standing_s = -np.inf
        self._report = CabinReport(self._T_imu_cabin, self._turn)
        self._datum = None if settings.datum is None else np.array(settings.datum)
        self._head: InertialState | None = None
        self._restart()

    def _restart(self) -> None:
        settings = self._settings
        self._first = FirstState(settings.rest, settings.moving_start, self._antennas_imu, self._noise)
        self._trailing: TrailingFilter | None = None
        self._newest: Inertial | None = None
        self._used_fix_s = -np.inf
        self._gated = 0
        self._moving_s = -np.inf

    @property
    def refused(self) -> Mapping[str, int]:
        """Number of refused samples by stream and reason."""
        return dict(self._door.refused)

    def add_imu(self, sample: ImuSample) -> None:
        if not self._door.admits(sample.frame, sample.stamp_s, _JUMP_S):
            return
        rate, force = sample.angular_velocity_rad_s, sample.specific_force_m_s2
        if _largest(rate) > _MAX_RATE_RAD_S or _largest(force) > _MAX_FORCE_M_S2:
            self._door.refuse(sample.frame, "out of range")
        elif sample.frame == self._settings.imu:
            since_last_s = sample.stamp_s - self._newest.stamp_s if self._newest is not None else 0.0
            self._add_cabin_sample(Inertial(sample.stamp_s, rate, force, since_last_s))
        elif sample.frame == self._settings.chassis_imu:
            self._standing.add(sample.stamp_s, rate, force)

    def _add_cabin_sample(self, sample: Inertial) -> None:
        if not 0 <= sample.since_last_s <= self._settings.restart_after_s:
            self._door.refuse(self._settings.imu, "gap, started again")
            self._restart()
        self._newest = sample
        if self._trailing is not None:
            self._trailing.add_sample(sample)
            self._head = self._trailing.head
        else:
            self._begin(sample)

    def _begin(self, sample: Inertial) -> None:
        first = self._first.add_sample(sample, self._turn.velocity_rad_s)
        if first is None:
            return
        self._trailing = TrailingFilter(self._make_filter(*first), self._noise, self._settings.lag_s, self._report)
        self._used_fix_s = sample.stamp_s
        if self._head is not None:
            self._report.correct(self._head, first[0])
        self._head = first[0]

    def _make_filter(self, state: InertialState, covariance: Float) -> ErrorStateFilter:
        return ErrorStateFilter(state, covariance, self._noise)

    def add_gnss(self, fix: GnssFix) -> None:
        if fix.antenna not in self._antennas_imu:
            self._door.refuse(fix.antenna, "unknown antenna")
            return
        if not self._door.admits(fix.antenna, fix.stamp_s):
            return
        noise = self._settings.gnss_scale**2 * fix.covariance_enu_m2
        if not fix.is_rtk_fixed or not 0 < np.diag(noise).max() < self._settings.max_gnss_std_m**2:
            self._door.refuse(fix.antenna, "too uncertain")
            return
        self._datum = np.array(fix.geodetic) if self._datum is None else self._datum
        p_map = enu_from_geodetic(fix.geodetic, self._datum)
        if self._trailing is None:
            self._first.add_fix(fix.stamp_s, fix.antenna, p_map)
        self._queue(fix.antenna, fix.stamp_s, lambda at: self._correct_by_fix(at, fix.antenna, p_map, noise))

    def add_odometry(self, increment: LidarIncrement) -> None:
        """Take no notice: this filter is the one without lidar."""

    def add_joints(self, sample: JointSample) -> None:
        if not self._door.admits("joints", sample.stamp_s):
            return
        self._turn.update(sample)
        is_due = sample.stamp_s - self._standing_s >= _STANDING_PERIOD_S - 1e-6
        if is_due and self._standing.stands(sample.stamp_s):
            self._standing_s = sample.stamp_s
            rate_cabin = self._turn.rate_cabin
            self._queue("joints", sample.stamp_s, lambda at: self._correct_by_standing(at, rate_cabin))

    def _queue(self, stream: str, stamp_s: float, apply: Callable[[ErrorStateFilter], None]) -> None:
        trailing = self._trailing
        if trailing is not None and not trailing.add(Correction(stamp_s, lambda: apply(trailing.kalman))):
            self._door.refuse(stream, "too late")

    def _correct_by_fix(self, kalman: ErrorStateFilter, antenna: str, p_map_antenna: Float, noise: Float) -> None:
        residual, H = antenna_residual(kalman.state, self._antennas_imu[antenna], p_map_antenna)
        if kalman.correct(residual, H, noise, self._settings.gate):
            self._used_fix_s = max(self._used_fix_s, kalman.state.stamp_s)
            self._gated = 0
            return
        self._door.refuse(antenna, "outlier")
        self._gated += 1
        if self._gated >= self._settings.reacquire_after:  # so many agree against the filter: it is the one to doubt
            kalman.doubt(float(np.linalg.norm(residual)), 0.5, 0.1)
            self._gated = 0
            self._moving_s = kalman.state.stamp_s  # in doubt it would believe anything

    def _correct_by_standing(self, kalman: ErrorStateFilter, rate_cabin: Float) -> None:
        """A chassis that drives smoothly looks as if it stood: what the filter contradicts is not believed soon."""
        if kalman.state.stamp_s - self._moving_s < _DOUBT_S:
            return
        settings, gate = self._settings.standing, self._settings.gate
        residual, H = standing_residual(kalman.state, self._T_imu_cabin[:3, 3])
        if not kalman.correct(residual, H, settings.velocity_std_m_s**2 * np.eye(3), gate):
            self._moving_s = kalman.state.stamp_s
            return
        if np.linalg.norm(rate_cabin) < settings.rate_std_rad_s:  # encoders differentiate well at rest only
            residual, H = rate_residual(kalman.state, self._T_imu_cabin[:3, :3] @ rate_cabin)
            kalman.correct(residual, H, settings.rate_std_rad_s**2 * np.eye(3), gate)

    def state(self) -> BaseState:
        if self._trailing is None or not self._turn.is_known:
            return CabinReport.unknown(self._newest.stamp_s if self._newest else 0.0, INITIALISING)
        head = self._trailing.head
        is_global = head.stamp_s - self._used_fix_s <= self._settings.fallback_after_s
        return self._report.report(head, self._trailing.covariance(), GLOBAL if is_global else FALLBACK)


def _largest(v: Float) -> float:
    """Return the largest magnitude; on plain floats, for three numbers are too few for NumPy."""
    largest: float = max(map(abs, v.tolist()))
    return largest
