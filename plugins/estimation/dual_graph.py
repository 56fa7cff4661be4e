"""Estimation by two factor graphs over inertial, satellite and lidar measurements, propagated at each sample."""

from collections import Counter
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
from plugins.estimation.graph_measurements import Fix, Increment, Measurement, Standing
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import Inertial, skew
from plugins.estimation.live_head import OUT_OF_RANGE, LiveHead
from plugins.estimation.live_kernels import is_beyond_range
from plugins.estimation.smoother_process import InlineSmoother, ProcessSmoother, SmootherHost
from plugins.estimation.unordered_door import UnorderedDoor
from robot_models.rig import Rig

INITIALISING = "INITIALISING"
_JUMP_S = 2.0  # an inertial stamp so far ahead is believed if the next one agrees; less is a gap, and bridged
_STANDING_PERIOD_S = 0.1


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
        self._datum = None if settings.datum is None else np.array(settings.datum)
        self._refused: Counter[str] = Counter()
        self.changes: list[ModeChange] = []
        self._host = self._made_host()
        gap_s = settings.restart_after_s
        self._head = LiveHead(self._T_imu_cabin, self._turn, self._noise, gap_s, self._host.memory)
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
        self._newest_s: float | None = None
        self._is_begun = False
        self._mode = Mode.GLOBAL

    @property
    def _now_s(self) -> float:
        return self._newest_s if self._newest_s is not None else np.inf

    @property
    def refused(self) -> Mapping[str, int]:
        """Number of refused samples by stream and reason."""
        return dict(self._door.refused + self._refused)

    def add_imu(self, sample: ImuSample) -> None:
        if not self._door.admits(sample.frame, sample.stamp_s, _JUMP_S):
            return
        if sample.frame == self._settings.imu:
            self._add_cabin_sample(sample)
        elif sample.frame == self._settings.chassis_imu:
            if is_beyond_range(sample.angular_velocity_rad_s, sample.specific_force_m_s2):
                self._door.refuse(sample.frame, "out of range")
            else:
                self._standing.add(sample.stamp_s, sample.angular_velocity_rad_s, sample.specific_force_m_s2)

    def _add_cabin_sample(self, sample: ImuSample) -> None:
        """Go on to a sample; what is here for each one is little, see `live_kernels`."""
        newest_s = self._newest_s
        if not self._is_begun or newest_s is None:
            self._begin(sample)
            return
        answered = self._head.step(sample.stamp_s, sample.angular_velocity_rad_s, sample.specific_force_m_s2)
        if answered < 0:
            self._refuse(sample, answered)
            return
        self._newest_s = sample.stamp_s
        news = self._host.sampled(self._head, sample, sample.stamp_s - newest_s, answered)
        if news is not None:
            self._mode = news.mode
            if news.changes or news.refused:
                self.changes.extend(news.changes)
                self._refused.update(news.refused)

    def _refuse(self, sample: ImuSample, why: int) -> None:
        """Count a sample that the head has not gone on to; after too long a gap it is the first of a new start."""
        if why == OUT_OF_RANGE:
            self._door.refuse(sample.frame, "out of range")
            return
        self._door.refuse(sample.frame, "gap, started again")
        self._restart()
        self._begin(sample)

    def _begin(self, sample: ImuSample) -> None:
        rate, force = sample.angular_velocity_rad_s, sample.specific_force_m_s2
        if is_beyond_range(rate, force):
            self._door.refuse(sample.frame, "out of range")
            return
        since_last_s = sample.stamp_s - self._newest_s if self._newest_s is not None else 0.0
        if not 0 <= since_last_s <= self._settings.restart_after_s:
            self._door.refuse(sample.frame, "gap, started again")
            self._restart()
        self._newest_s = sample.stamp_s
        inertial = Inertial(sample.stamp_s, rate, force, since_last_s)
        first = self._first.add_sample(inertial, self._turn.velocity_rad_s)
        if first is not None:
            self._is_begun = True
            self._begun_s = sample.stamp_s
            self._host.begin(self._head, *first)

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
        self._head.turned()
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
        if not self._is_begun or not self._turn.is_known:
            return CabinReport.unknown(self._newest_s or 0.0, INITIALISING)
        return self._head.state(self._mode.value)


def _adjoint(T: Float) -> Float:
    """Return the map of (rotation, translation) errors in the second frame to the first, shape (6, 6)."""
    J = np.zeros((6, 6))
    J[:3, :3] = J[3:, 3:] = T[:3, :3]
    J[3:, :3] = skew(T[:3, 3]) @ T[:3, :3]
    return J
