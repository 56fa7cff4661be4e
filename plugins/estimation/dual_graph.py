"""Estimation by two factor graphs over inertial, satellite and lidar measurements, propagated at each sample."""

from collections import Counter, deque
from collections.abc import Mapping, Sequence

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
from executive.messages.status_change import StatusChange
from plugins.estimation.cabin_report import CabinReport
from plugins.estimation.cabin_sensors import antennas_in_imu, cabin_imu
from plugins.estimation.chassis import StandingDetector, TurnJoint
from plugins.estimation.doorkeeper import Doorkeeper
from plugins.estimation.dual_graph_settings import DualGraphSettings
from plugins.estimation.estimator_modes import Mode, ModeChange
from plugins.estimation.first_state import FirstState
from plugins.estimation.graph_estimate import Estimate
from plugins.estimation.graph_measurements import Fix, Increment, Measurement, Standing
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import (
    Inertial,
    InertialState,
    carry_covariance,
    propagate,
    propagate_through,
    skew,
)
from plugins.estimation.smoother_process import InlineSmoother, ProcessSmoother, SmootherHost
from plugins.estimation.unordered_door import UnorderedDoor
from robot_models.rig import Rig

INITIALISING = "INITIALISING"
_MAX_RATE_RAD_S = 35.0  # 2000 deg/s: the range of a MEMS sensor
_MAX_FORCE_M_S2 = 160.0  # 16 g
_JUMP_S = 2.0  # an inertial stamp so far ahead is believed if the next one agrees; less is a gap, and bridged
_STANDING_PERIOD_S = 0.1
_COVARIANCE_PERIOD_S = 0.049


class DualGraph(Estimator):
    """The paper's estimator (Nubert 2022, Sec. IV): each inertial sample is propagated at once, and whenever a fix or
    a lidar increment comes, the smoother's answer takes the propagation's place and is carried on to the newest sample.

    Attributes:
        changes: Changes of the mode since the start, with their reasons.
    """

    Settings = DualGraphSettings

    def __init__(self, settings: DualGraphSettings, machine: Rig) -> None:
        self._settings = settings
        self._machine = machine

    def start(self) -> None:
        settings = self._settings
        imu = cabin_imu(self._machine, settings.imu)
        self._noise = InertialNoise.of(imu, settings.noise_factor, settings.gravity_m_s2)
        self._T_imu_cabin = inverse(imu.T_link_sensor)
        self._antennas_imu = antennas_in_imu(self._machine, imu)
        self._door = Doorkeeper()
        self._late_door = UnorderedDoor(self._door)
        self._turn = TurnJoint(self._machine)
        self._standing = StandingDetector(settings.standing)
        self._standing_s = -np.inf
        self._report = CabinReport(self._T_imu_cabin, self._turn)
        self._datum = None if settings.datum is None else np.array(settings.datum)
        self._refused: Counter[str] = Counter()
        self.changes: list[ModeChange] = []
        self._host = self._made_host()
        self._head: InertialState | None = None
        self._carried: tuple[float, Float] | None = None  # time and covariance
        self._restart()

    def _made_host(self) -> SmootherHost:
        settings = self._settings
        if settings.process:
            return ProcessSmoother(settings.smoother, self._noise, settings.answer_within_s)
        return InlineSmoother(settings.smoother, self._noise)

    def close(self) -> None:
        self._host.close()

    def _restart(self) -> None:
        settings = self._settings
        self._first = FirstState(settings.rest, settings.moving_start, self._antennas_imu, self._noise)
        self._newest: Inertial | None = None
        self._is_begun = False
        self._samples: deque[Inertial] = deque()  # since the newest estimate
        self._mode = Mode.GLOBAL

    @property
    def _now_s(self) -> float:
        return self._newest.stamp_s if self._newest is not None else np.inf

    @property
    def refused(self) -> Mapping[str, int]:
        """Number of refused samples by stream and reason."""
        return dict(self._door.refused + self._refused)

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
        if self._head is None or not self._is_begun:
            self._begin(sample)
            return
        self._head = propagate(self._head, sample, self._noise.gravity_m_s2)
        self._samples.append(sample)
        estimate = self._host.add_sample(sample)
        if estimate is not None:
            self._take(estimate)

    def _begin(self, sample: Inertial) -> None:
        first = self._first.add_sample(sample, self._turn.velocity_rad_s)
        if first is not None:
            self._estimated, self._covariance = first
            self._move_to(self._estimated)
            self._is_begun = True
            self._begun_s = sample.stamp_s
            self._host.begin(*first)

    def _take(self, estimate: Estimate) -> None:
        """Carry an estimate on to the newest sample, in the propagation's place."""
        self._estimated, self._covariance, self._mode = estimate.state, estimate.covariance, estimate.mode
        self.changes.extend(estimate.changes)
        self._refused.update(estimate.refused)
        while self._samples and self._samples[0].stamp_s <= estimate.state.stamp_s:
            self._samples.popleft()
        self._move_to(propagate_through(estimate.state, self._samples, self._noise.gravity_m_s2))

    def _move_to(self, head: InertialState) -> None:
        self._carried = None
        if self._head is not None:
            self._report.correct(self._head, head)
        self._head = head

    def add_gnss(self, fix: GnssFix) -> None:
        if fix.antenna not in self._antennas_imu:
            self._door.refuse(fix.antenna, "unknown antenna")
            return
        if not self._late_door.admits(fix.antenna, fix.stamp_s, self._now_s):
            return
        noise = self._settings.gnss_scale**2 * fix.covariance_enu_m2
        if not fix.is_rtk_fixed or not 0 < np.diag(noise).max() < self._settings.max_gnss_std_m**2:
            self._door.refuse(fix.antenna, "too uncertain")
            return
        if self._datum is None:
            self._datum = np.array(fix.geodetic)
        p_map = enu_from_geodetic(fix.geodetic, self._datum)
        if not self._is_begun:
            self._first.add_fix(fix.stamp_s, fix.antenna, p_map)
        self._hand_over(Fix(fix.stamp_s, fix.antenna, self._antennas_imu[fix.antenna], p_map, noise))

    def add_odometry(self, increment: LidarIncrement) -> None:
        if not increment.from_s < increment.to_s:
            self._door.refuse(increment.frame, "stamps not in order")
            return
        if not self._late_door.admits(increment.frame, increment.to_s, self._now_s):
            return
        T_imu_lidar = self._T_imu_cabin @ self._machine.sensors[increment.frame].T_link_sensor
        T_from_to = T_imu_lidar @ increment.T_from_to @ inverse(T_imu_lidar)
        J = _adjoint(T_imu_lidar)
        self._hand_over(Increment(increment.from_s, increment.to_s, T_from_to, J @ increment.covariance @ J.T))

    def add_joints(self, sample: JointSample) -> None:
        if not self._door.admits("joints", sample.stamp_s):
            return
        self._turn.update(sample)
        if sample.stamp_s - self._standing_s >= _STANDING_PERIOD_S - 1e-6 and self._standing.stands(sample.stamp_s):
            self._standing_s = sample.stamp_s
            rate_cabin = self._turn.rate_cabin
            rests = np.linalg.norm(rate_cabin) < self._settings.standing.rate_std_rad_s
            rate_imu = self._T_imu_cabin[:3, :3] @ rate_cabin if rests else None
            self._hand_over(Standing(sample.stamp_s, self._T_imu_cabin[:3, 3], rate_imu))

    def _hand_over(self, measurement: Measurement) -> None:
        if self._is_begun and measurement.stamp_s > self._begun_s:
            self._host.add(measurement)

    def account(self) -> Sequence[StatusChange]:
        return [StatusChange(c.stamp_s, str(c.before), str(c.after), c.reason) for c in self.changes]

    def state(self) -> BaseState:
        if self._head is None or not self._is_begun or not self._turn.is_known:
            return CabinReport.unknown(self._newest.stamp_s if self._newest else 0.0, INITIALISING)
        return self._report.report(self._head, self._head_covariance(self._head.stamp_s), self._mode.value)

    def _head_covariance(self, stamp_s: float) -> Float:
        """Return the covariance at the head; it grows so slowly that one of up to 50 ms ago is good enough."""
        if self._carried is None or stamp_s - self._carried[0] > _COVARIANCE_PERIOD_S:
            ahead_s = stamp_s - self._estimated.stamp_s
            P = carry_covariance(self._estimated, self._covariance, self._noise, ahead_s)
            self._carried = (stamp_s, P)
        return self._carried[1]


def _largest(v: Float) -> float:
    """Return the largest magnitude; on plain floats, for three numbers are too few for NumPy."""
    return float(max(map(abs, v.tolist())))


def _adjoint(T: Float) -> Float:
    """Return the map of (rotation, translation) errors in the second frame to the first, shape (6, 6)."""
    J = np.zeros((6, 6))
    J[:3, :3] = J[3:, 3:] = T[:3, :3]
    J[3:, :3] = skew(T[:3, 3]) @ T[:3, :3]
    return J
