"""Estimation by the cabin's inertial sensor, the satellite antennas and the turn joint."""

from bisect import insort
from collections import deque
from collections.abc import Callable, Mapping

import numpy as np

from executive.arrays import Float
from executive.errors import ConfigError
from executive.geometry.geodesy import enu_from_geodetic
from executive.geometry.pose import inverse, pose, transform
from executive.interfaces.estimation import Estimator
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.odometry import LidarIncrement
from plugins.estimation.chassis import StandingDetector, TurnJoint
from plugins.estimation.correction import Correction
from plugins.estimation.doorkeeper import Doorkeeper
from plugins.estimation.error_state_filter import ErrorStateFilter
from plugins.estimation.gnss_imu_settings import GnssImuSettings
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import POSITION, ROTATION, Inertial, InertialState, propagate, skew
from plugins.estimation.measurement_models import antenna_residual, rate_residual, standing_residual
from plugins.estimation.moving_start import MovingStart
from plugins.estimation.rest_initialisation import RestInitialisation
from robot_models.rig import Rig
from robot_models.sensor import Imu

INITIALISING, GLOBAL, FALLBACK = "INITIALISING", "GLOBAL", "FALLBACK"
_MAX_RATE_RAD_S = 35.0  # 2000 deg/s: the range of a MEMS sensor
_MAX_FORCE_M_S2 = 160.0  # 16 g
_COVARIANCE_PERIOD_S = 0.049
_REST_PERIOD_S = 0.1  # between looks for rest, which cost milliseconds, where a long rest is followed for its end
_POSE = np.r_[ROTATION, POSITION]


class GnssImuFilter(Estimator):
    """An error-state Kalman filter on the cabin; heading comes with the antennas' lever arms.

    With one antenna it begins after the first metres of motion, and heading is known as far as the body accelerates.

    The role of the paper's baseline, the two-state implicit filter: inertial and satellite measurements only (Nubert
    2022, Sec. V). The filter itself trails by `lag_s`, so that measurements of whatever latency are used at their own
    time and in order; the state at the newest inertial sample is predicted from it.

    Attributes:
        refused: Number of refused samples by stream and reason.
    """

    Settings = GnssImuSettings

    def __init__(self, settings: GnssImuSettings, machine: Rig) -> None:
        self._settings = settings
        self._machine = machine

    def start(self) -> None:
        settings = self._settings
        imu = self._cabin_imu()
        self._door = Doorkeeper()
        self._noise = InertialNoise.of(imu, settings.noise_factor, settings.gravity_m_s2)
        self._T_imu_cabin = inverse(imu.T_link_sensor)
        self._antennas_imu = self._antennas()
        self._turn = TurnJoint(self._machine)
        self._standing = StandingDetector(settings.standing)
        self._datum = None if settings.datum is None else np.array(settings.datum)
        self._corrections: list[Correction] = []
        self._T_odom_cabin: Float | None = None
        self._last: BaseState | None = None
        self._standing_s = -np.inf
        self._restart()

    def _restart(self) -> None:
        self._filter: ErrorStateFilter | None = None
        self._rest = RestInitialisation(self._settings.rest, self._antennas_imu, self._noise)
        arm = next(iter(self._antennas_imu.values()))
        self._moving = MovingStart(self._settings.moving_start, arm, self._noise)
        self._samples: deque[Inertial] = deque()
        self._corrections.clear()
        self._newest: Inertial | None = None
        self._begin_s = self._used_fix_s = self._tried_s = -np.inf
        self._gated = 0
        self._predicted: InertialState | None = None
        self._is_corrected = False
        self._covariance_s = -np.inf

    def _cabin_imu(self) -> Imu:
        sensor = self._machine.sensors.get(self._settings.imu)
        if not isinstance(sensor, Imu) or sensor.link != self._machine.cabin_link:
            names = ", ".join(s.name for s in self._machine.sensors_of("imu") if s.link == self._machine.cabin_link)
            raise ConfigError(f"estimation: '{self._settings.imu}' is no imu on the cabin; there is: {names}")
        return sensor

    def _antennas(self) -> Mapping[str, Float]:
        """Return the antennas' phase centres in IMU axes [m]."""
        gnss = [s for s in self._machine.sensors_of("gnss") if s.link == self._machine.cabin_link]
        if not gnss:
            raise ConfigError(f"estimation: {self._machine.name} has no gnss antenna on the cabin; one is needed")
        return {s.name: transform(self._T_imu_cabin, s.T_link_sensor[:3, 3]) for s in gnss}

    @property
    def refused(self) -> Mapping[str, int]:
        """Number of refused samples by stream and reason."""
        return dict(self._door.refused)

    def add_imu(self, sample: ImuSample) -> None:
        if not self._door.admits(sample.frame, sample.stamp_s):
            return
        rate, force = sample.angular_velocity_rad_s, sample.specific_force_m_s2
        if np.abs(rate).max() > _MAX_RATE_RAD_S or np.abs(force).max() > _MAX_FORCE_M_S2:
            self._door.refuse(sample.frame, "out of range")
        elif sample.frame == self._settings.imu:
            since_last_s = sample.stamp_s - self._newest.stamp_s if self._newest is not None else 0.0
            self._add_cabin_sample(Inertial(sample.stamp_s, rate, force, since_last_s))
        elif sample.frame == self._settings.chassis_imu:
            self._standing.add(sample.stamp_s, rate, force)

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
        if self._filter is None:
            self._rest.add_fix(fix.stamp_s, fix.antenna, p_map)
            self._moving.add_fix(fix.stamp_s, p_map)
        self._queue(fix.antenna, fix.stamp_s, lambda: self._correct_by_fix(fix.antenna, fix.stamp_s, p_map, noise))

    def add_odometry(self, increment: LidarIncrement) -> None:
        """Take no notice: this filter is the one without lidar."""

    def add_joints(self, sample: JointSample) -> None:
        if not self._door.admits("joints", sample.stamp_s):
            return
        self._turn.update(sample)
        if sample.stamp_s - self._standing_s >= 0.1 - 1e-6 and self._standing.stands(sample.stamp_s):
            self._standing_s = sample.stamp_s
            rate_cabin = self._turn.rate_cabin
            self._queue("joints", sample.stamp_s, lambda: self._correct_by_standing(rate_cabin))

    def _queue(self, stream: str, stamp_s: float, apply: Callable[[], None]) -> None:
        if self._filter is None or stamp_s <= self._begin_s:
            return
        if stamp_s < self._filter.state.stamp_s:
            self._door.refuse(stream, "too late")
            return
        insort(self._corrections, Correction(stamp_s, apply))

    def _add_cabin_sample(self, sample: Inertial) -> None:
        if sample.since_last_s > self._settings.restart_after_s:
            self._door.refuse(self._settings.imu, "gap, started again")
            self._restart()
        self._newest = sample
        if self._filter is not None:
            self._samples.append(sample)
            self._advance(sample.stamp_s - self._settings.lag_s)
            return
        first = self._first_state(sample)
        if first is not None:
            self._filter = self._make_filter(*first)
            self._begin_s = self._used_fix_s = sample.stamp_s

    def _first_state(self, sample: Inertial) -> tuple[InertialState, Float] | None:
        """Return a state from rest, and with one antenna from the motion after it, as soon as there is one."""
        self._rest.add_sample(sample)
        if len(self._antennas_imu) > 1:
            is_turning = abs(self._turn.velocity_rad_s) >= self._settings.rest.max_rate_rad_s
            return None if is_turning else self._rest.state()
        self._moving.add_sample(sample)
        if sample.stamp_s - self._tried_s >= _REST_PERIOD_S:
            self._tried_s = sample.stamp_s
            at_rest = self._rest.state()
            if at_rest is not None:
                self._moving.begin(*at_rest)
        return self._moving.state()

    def _make_filter(self, state: InertialState, covariance: Float) -> ErrorStateFilter:
        return ErrorStateFilter(state, covariance, self._noise)

    def _advance(self, until_s: float) -> None:
        """Predict up to a time, correcting on the way by all that was measured until then."""
        while self._corrections and self._corrections[0].stamp_s <= until_s:
            correction = self._corrections.pop(0)
            self._predict(correction.stamp_s)
            correction.apply()
            self._is_corrected = True
        self._predict(until_s)

    def _predict(self, until_s: float) -> None:
        kalman = self._running()
        while self._samples and self._samples[0].stamp_s <= until_s:
            kalman.predict(self._samples.popleft())
        if self._samples and kalman.state.stamp_s < until_s:
            kalman.predict(self._samples[0].until(until_s))

    def _running(self) -> ErrorStateFilter:
        if self._filter is None:
            raise RuntimeError("the filter is not initialised")
        return self._filter

    def _correct_by_fix(self, antenna: str, stamp_s: float, p_map_antenna: Float, noise: Float) -> None:
        kalman = self._running()
        residual, H = antenna_residual(kalman.state, self._antennas_imu[antenna], p_map_antenna)
        if kalman.correct(residual, H, noise, self._settings.gate):
            self._used_fix_s = max(self._used_fix_s, stamp_s)
            self._gated = 0
            return
        self._door.refuse(antenna, "outlier")
        self._gated += 1
        if self._gated >= self._settings.reacquire_after:  # so many agree against the filter: it is the one to doubt
            kalman.doubt(float(np.linalg.norm(residual)), 0.5, 0.1)
            self._gated = 0

    def _correct_by_standing(self, rate_cabin: Float) -> None:
        kalman, settings, gate = self._running(), self._settings.standing, self._settings.gate
        residual, H = standing_residual(kalman.state, self._T_imu_cabin[:3, 3])
        kalman.correct(residual, H, settings.velocity_std_m_s**2 * np.eye(3), gate)
        if np.linalg.norm(rate_cabin) < settings.rate_std_rad_s:  # encoders differentiate well at rest only
            residual, H = rate_residual(kalman.state, self._T_imu_cabin[:3, :3] @ rate_cabin)
            kalman.correct(residual, H, settings.rate_std_rad_s**2 * np.eye(3), gate)

    def state(self) -> BaseState:
        if self._filter is None or not self._turn.is_known:
            return self._unknown()
        head, at_last = self._head()
        T_map_cabin = pose(head.R_map_imu, head.p_map_imu) @ self._T_imu_cabin
        T_odom_cabin = self._T_odom(T_map_cabin, at_last)
        T_cabin_base = self._turn.T_cabin_base(head.stamp_s)
        self._T_odom_cabin = T_odom_cabin
        rate, arm = head.rate, self._T_imu_cabin[:3, 3]
        R_cabin_imu = self._T_imu_cabin[:3, :3].T
        self._last = BaseState(
            stamp_s=head.stamp_s,
            T_map_base=T_map_cabin @ T_cabin_base,
            T_odom_base=T_odom_cabin @ T_cabin_base,
            T_map_cabin=T_map_cabin,
            v_map_cabin=head.v_map_imu + head.R_map_imu @ skew(rate) @ arm,
            w_map_cabin_in_cabin=R_cabin_imu @ rate,
            covariance=self._covariance(head),
            status=GLOBAL if head.stamp_s - self._used_fix_s <= self._settings.fallback_after_s else FALLBACK,
        )
        return self._last

    def _unknown(self) -> BaseState:
        stamp_s, nowhere = self._newest.stamp_s if self._newest else 0.0, np.eye(4)
        return BaseState(stamp_s, nowhere, nowhere, nowhere, np.zeros(3), np.zeros(3), 1e6 * np.eye(6), INITIALISING)

    def _head(self) -> tuple[InertialState, InertialState | None]:
        """Predict to the newest sample; also give the newest estimate of the state that was returned last.

        Without a correction since, the last prediction goes on; with one, it begins again `lag_s` ago.
        """
        last, behind = self._predicted, self._running().state
        head = behind if last is None or self._is_corrected or behind.stamp_s >= last.stamp_s else last
        at_last = head if last is not None and head.stamp_s == last.stamp_s else None
        for sample in self._samples:
            if sample.stamp_s > head.stamp_s:
                head = propagate(head, sample, self._noise.gravity_m_s2)
                if last is not None and head.stamp_s == last.stamp_s:
                    at_last = head
        self._predicted, self._is_corrected = head, False
        return head, at_last

    def _T_odom(self, T_map_cabin: Float, at_last: InertialState | None) -> Float:
        """Chain increments of the newest estimate, so that corrections of the past never step the odometry frame."""
        if self._T_odom_cabin is None or self._last is None:
            return T_map_cabin
        T_map_last = self._last.T_map_cabin
        if at_last is not None:
            T_map_last = pose(at_last.R_map_imu, at_last.p_map_imu) @ self._T_imu_cabin
        return self._T_odom_cabin @ inverse(T_map_last) @ T_map_cabin

    def _covariance(self, head: InertialState) -> Float:
        """Return the covariance at a prediction; it grows so slowly that one of up to 50 ms ago is good enough."""
        if not 0 <= head.stamp_s - self._covariance_s < _COVARIANCE_PERIOD_S:
            self._covariance_s = head.stamp_s
            self._newest_covariance = self._cabin_covariance(head)
        return self._newest_covariance

    def _cabin_covariance(self, head: InertialState) -> Float:
        """Move the covariance from the IMU, in its axes and the map's, to the cabin's origin and axes."""
        kalman = self._running()
        P = kalman.covariance_after(head.stamp_s - kalman.state.stamp_s)
        R_cabin_imu, arm = self._T_imu_cabin[:3, :3].T, self._T_imu_cabin[:3, 3]
        J = np.zeros((6, 6))
        J[:3, :3] = R_cabin_imu
        J[3:, :3] = -R_cabin_imu @ skew(arm)
        J[3:, 3:] = R_cabin_imu @ head.R_map_imu.T
        return np.asarray(J @ P[np.ix_(_POSE, _POSE)] @ J.T)
