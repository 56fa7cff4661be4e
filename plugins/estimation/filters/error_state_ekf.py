"""Estimation by inertial, satellite and lidar measurements in one error-state Kalman filter."""

from dataclasses import replace

import numpy as np
from executive_plugins.estimation.filters.cloning_filter import CloningFilter, IncrementInnovation
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.filters.settings import ErrorStateEkfSettings
from executive_plugins.estimation.filters.status_account import FALLBACK, GLOBAL
from executive_plugins.estimation.gate.increment_record import IncrementRecord
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.start.found import Found

from executive.arrays import Float
from executive.errors import ConfigError
from executive.geometry.pose import adjoint, inverse
from executive.machine.rig import Rig
from executive.messages.odometry import LidarIncrement


class ErrorStateEkf(GnssImuFilter):
    """The paper's second baseline, similar to MSF (Nubert 2022, Sec. V; Lynen 2013).

    It extends the inertial-satellite filter, including its handling of delays: a measurement that
    is late by less than `lag_s` is used at its own time. Lidar increments are used as relative
    poses, so that the drift in a satellite outage is that of the odometry, not that of the inertial
    sensor. There is only one frame: a correction steps the map pose.
    """

    Settings = ErrorStateEkfSettings

    def __init__(self, settings: ErrorStateEkfSettings, machine: Rig) -> None:
        super().__init__(settings, machine)
        self._lidar = settings

    def add_odometry(self, increment: LidarIncrement) -> None:
        stream = f"odometry {increment.frame}"
        if self._stamp_gate.admits(stream, increment.to_s):
            self._queue(
                stream, increment.to_s, lambda _: self._correct_by_increment(stream, increment)
            )

    def _make_filter(self, found: Found) -> ErrorStateFilter:
        self._records: dict[str, IncrementRecord] = {}
        self._cloning = CloningFilter(found.state, found.covariance, self._noise, found.clock)
        return self._cloning

    def _correct_by_increment(self, stream: str, increment: LidarIncrement) -> None:
        """Correct by the motion since the last increment's end, and clone the pose again.

        The first increment only clones the pose.
        """
        kalman = self._cloning
        if kalman.has_clone_at(increment.from_s):
            T_imu_lidar = self._T_imu_lidar(increment.frame)
            T_from_to = T_imu_lidar @ increment.T_from_to @ inverse(T_imu_lidar)
            Ad = adjoint(T_imu_lidar)
            covariance = self._lidar.odometry_scale**2 * Ad @ increment.covariance @ Ad.T
            refused = self._refusal(stream, kalman.increment(T_from_to, covariance))
            if refused:
                self._stamp_gate.refuse(stream, refused)
        kalman.clone()

    def _refusal(self, stream: str, innovation: IncrementInnovation) -> str:
        """Correct by an increment; return why it was not used, empty if it was.

        Fixes and inertial samples outvote odometry that leans, unless they contradict each other as
        well, or there are no fixes.
        """
        gate, status = self._lidar.odometry_gate, self._status()
        record = self._records.setdefault(stream, IncrementRecord(gate))
        if status == FALLBACK:
            record.acquit()
        noise = record.take(
            self._cloning.state.stamp_s,
            innovation.residual,
            innovation.predicted,
            innovation.noise,
            status == GLOBAL,
        )
        if noise is None:
            return "contradicted by fixes and inertial samples" if record.is_wrong else "outlier"
        is_used = self._cloning.correct_by_increment(replace(innovation, noise=noise), gate)
        return "" if is_used else "outlier"

    def _T_imu_lidar(self, frame: str) -> Float:
        sensor = self._machine.sensors.get(frame)
        if sensor is None or sensor.link != self._machine.cabin_link:
            raise ConfigError(
                f"estimation: there is odometry of '{frame}', but no such sensor on the cabin"
            )
        return np.asarray(self._T_imu_cabin @ sensor.T_link_sensor)
