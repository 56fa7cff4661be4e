"""Estimation by two factor graphs over inertial, satellite and lidar measurements."""

from collections import Counter
from collections.abc import Mapping

import numpy as np
from executive_plugins.estimation.cabin.estimator import UNKNOWN_BODY_GATE, CabinEstimator
from executive_plugins.estimation.gate.measurements import Fix, Increment, Measurement, Standstill
from executive_plugins.estimation.gate.unordered_stamp_gate import UnorderedStampGate
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.settings import DualGraphSettings
from executive_plugins.estimation.graph.smoother_process import (
    InlineSmoother,
    ProcessSmoother,
    SmootherHost,
)
from executive_plugins.estimation.live.modes import Mode, ModeChange
from executive_plugins.estimation.start.chassis import ChassisRest
from executive_plugins.estimation.start.found import Found
from typing_extensions import Buffer

from executive.arrays import Float
from executive.geometry.pose import adjoint, inverse
from executive.interfaces.recorded_log import RecordedBody
from executive.machine.rig import Rig
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement
from executive.messages.status_change import StatusChange


class DualGraph(CabinEstimator):
    """The paper's estimator (Nubert 2022, Sec. IV).

    Each inertial sample is propagated at once. Whenever a fix or a lidar increment arrives, the
    smoother computes a new estimate, which is propagated to the newest sample and replaces the
    state there.

    Attributes:
        changes: Changes of the mode since the start, with their reasons.
    """

    Settings = DualGraphSettings

    def __init__(self, settings: DualGraphSettings, machine: Rig) -> None:
        super().__init__(settings, machine)
        self._settings = settings
        self._started: SmootherHost | None = None

    @classmethod
    def settings_for(cls, body: RecordedBody) -> Mapping[str, object]:
        known = super().settings_for(body)
        gate = {"innovation": UNKNOWN_BODY_GATE}
        return known if body.is_described else {**known, "smoother": {"gate": gate}}

    def start(self) -> None:
        super().start()
        self._late_stamp_gate = UnorderedStampGate(self._stamp_gate)
        self._refused: Counter[str] = Counter()
        self.changes: list[ModeChange] = []

    def _shared_memory(self) -> Buffer | None:
        self._host = self._started = self._made_host()
        return self._host.memory

    def _made_host(self) -> SmootherHost:
        settings = self._settings
        if settings.process:
            return ProcessSmoother(settings.smoother, self._noise, settings.answer_within_s)
        return InlineSmoother(settings.smoother, self._noise)

    def close(self) -> None:
        if self._started is not None:
            self._started.close()

    def _restart(self) -> None:
        super()._restart()
        self._mode = Mode.GLOBAL
        self._late_s = 0.0  # stamps of the fixes minus times of measurement, by the start
        self._fix_scale = 1.0  # on the variance that fixes declare, by the start

    @property
    def refused(self) -> Mapping[str, int]:
        """Number of refused samples by stream and reason."""
        return dict(self._stamp_gate.refused + self._refused)

    def _start_at(self, found: Found) -> None:
        self._begun_s, self._late_s = found.state.stamp_s, found.clock.offset_s
        self._fix_scale = found.fix_scale
        agreeing = self._agreeing_clock()
        first = GraphEstimate(found.state, found.covariance, found.clock, agreeing)
        self._host.begin(self._propagator, first)

    def _sampled(self, sample: ImuSample, since_last_s: float, answered: int) -> None:
        update = self._host.sampled(self._propagator, sample, since_last_s, answered)
        if update is not None:
            self._mode = update.mode
            if update.changes or update.refused:
                self.changes.extend(update.changes)
                self._status_changes += [
                    StatusChange(c.stamp_s, str(c.before), str(c.after), c.reason)
                    for c in update.changes
                ]
                self._refused.update(update.refused)

    @property
    def _now_s(self) -> float:
        return self._newest_s if self._newest_s is not None else np.inf

    def _admits_fix(self, fix: GnssFix) -> bool:
        return self._late_stamp_gate.admits(fix.antenna, fix.stamp_s, self._now_s)

    def _use_fix(self, fix: GnssFix, p_map_antenna: Float, noise: Float) -> None:
        at_s, arm_imu = fix.stamp_s - self._late_s, self._antennas_imu[fix.antenna]
        scaled = self._fix_scale * noise
        self._hand_over(Fix(at_s, fix.antenna, arm_imu, p_map_antenna, scaled, self._late_s))

    def add_odometry(self, increment: LidarIncrement) -> None:
        if not increment.from_s < increment.to_s:
            self._stamp_gate.refuse(increment.frame, "stamps not in order")
            return
        if not self._late_stamp_gate.admits(increment.frame, increment.to_s, self._now_s):
            return
        T_imu_lidar = self._T_imu_cabin @ self._machine.sensors[increment.frame].T_link_sensor
        T_from_to = T_imu_lidar @ increment.T_from_to @ inverse(T_imu_lidar)
        J = adjoint(T_imu_lidar)
        self._hand_over(
            Increment(increment.from_s, increment.to_s, T_from_to, J @ increment.covariance @ J.T)
        )

    def _use_standing(self, rest: ChassisRest) -> None:
        rests = np.linalg.norm(rest.rate_cabin) < self._settings.standing.rate_std_rad_s
        rate_imu = self._T_imu_cabin[:3, :3] @ rest.rate_cabin if rests else None
        arm_imu, sway = self._T_imu_cabin[:3, 3], (rest.sway_m_s, rest.sway_rad_s)
        self._hand_over(Standstill(rest.stamp_s, arm_imu, rate_imu, *sway))

    def _hand_over(self, measurement: Measurement) -> None:
        if self._is_begun and measurement.stamp_s > self._begun_s:
            self._host.add(measurement)

    def _status(self) -> str:
        return self._mode.value
