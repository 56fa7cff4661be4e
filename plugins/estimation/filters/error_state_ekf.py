"""Estimation by inertial, satellite and lidar measurements in one error-state Kalman filter."""

from dataclasses import replace
from functools import partial

import numpy as np
from executive_plugins.estimation.filters.cloning_filter import CloningFilter, IncrementInnovation
from executive_plugins.estimation.filters.gnss_imu_filter import GnssImuFilter
from executive_plugins.estimation.filters.settings import ErrorStateEkfSettings
from executive_plugins.estimation.filters.status_account import FALLBACK, GLOBAL
from executive_plugins.estimation.filters.witnessed_filter import WitnessedFilter
from executive_plugins.estimation.gate.increment_record import IncrementRecord
from executive_plugins.estimation.gate.innovation_record import INNOVATIONS
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.gate.odometry_trial import OdometryTrial, drift2
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.trailing_filter import Correction
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
    _can_return = False  # two filters, each of which would have to return

    def __init__(self, settings: ErrorStateEkfSettings, machine: Rig) -> None:
        super().__init__(settings, machine)
        self._lidar = settings

    def add_odometry(self, increment: LidarIncrement) -> None:
        """Use an increment; one that is late is waited for only while there are no fixes."""
        stream, trailing = f"odometry {increment.frame}", self._trailing
        if not self._stamp_gate.admits(stream, increment.to_s) or trailing is None:
            return
        apply = partial(self._correct_by_increment, stream, increment)
        is_awaited = self._status() == FALLBACK
        if not trailing.add(Correction(increment.to_s, apply), is_awaited):
            self._stamp_gate.refuse(stream, "too late")

    def _make_filter(self, found: Found) -> ErrorStateFilter:
        settings = self._lidar
        self._records: dict[str, IncrementRecord] = {}
        self._pair = WitnessedFilter(found.state, found.covariance, self._noise, found.clock)
        self._trial = OdometryTrial(self._pair, settings.reacquire_after_s)
        return self._pair

    @property
    def _user(self) -> CloningFilter:
        """The filter that uses odometry."""
        return self._pair if self._trial.trusts else self._pair.other

    def _start_at(self, found: Found) -> None:
        super()._start_at(found)
        rows = np.zeros(len(self._streams.records), INNOVATIONS)
        self._pair.judge_by(self._streams.records, self._new_records(found, rows))

    def _correct_by_fix(self, kalman: ErrorStateFilter, fix: Fix, late_s: float) -> bool:
        is_used = super()._correct_by_fix(kalman, fix, late_s)
        if kalman is not self._pair:  # the filter has begun anew since the fix was queued
            return is_used
        is_contradicted = not is_used or self._suspected_s == kalman.stamp_s
        period_s = self._streams.shared_period_s(fix.antenna)
        is_doubted = self._pair.correct_other(fix, late_s, period_s)
        other2 = None if is_doubted else self._pair.other.distance2
        if self._trial.takes_fix(is_contradicted, other2):
            self._used_fix_s = kalman.stamp_s
            self._refused.forget()
            return True
        return is_used

    def _correct_by_increment(self, stream: str, increment: LidarIncrement) -> None:
        """Correct by the motion since the last increment's end, and clone the pose again.

        The first increment only clones the pose.
        """
        trial, status = self._trial, self._status()
        if status == GLOBAL:
            trial.begin()
        elif status == FALLBACK:
            trial.trust()
        else:
            trial.dismiss()
        if self._user.has_clone_at(increment.from_s):
            T_imu_lidar = self._T_imu_lidar(increment.frame)
            T_from_to = T_imu_lidar @ increment.T_from_to @ inverse(T_imu_lidar)
            Ad = adjoint(T_imu_lidar)
            covariance = self._lidar.odometry_scale**2 * Ad @ increment.covariance @ Ad.T
            covariance[3:, 3:] += self._drift2(increment) * np.eye(3)
            refused = self._refusal(stream, self._user.increment(T_from_to, covariance))
            if refused:
                self._stamp_gate.refuse(stream, refused)
        self._user.clone()

    def _drift2(self, increment: LidarIncrement) -> float:
        """Return the variance of a drift since the last fix [m²], see `drift2`.

        It grows until fixes are missing: after that, nothing but odometry tells the velocity.
        """
        since_s = min(increment.to_s - self._used_fix_s, self._streams.missing_after_s)
        length_m = float(np.linalg.norm(increment.T_from_to[:3, 3]))
        steps = since_s / (increment.to_s - increment.from_s)
        return drift2(steps, self._lidar.odometry_drift * length_m)

    def _refusal(self, stream: str, innovation: IncrementInnovation) -> str:
        """Correct by an increment; return why it was not used, empty if it was.

        Fixes and inertial samples outvote odometry that leans, or that separates the filters,
        unless they contradict each other as well, or there are no fixes.
        """
        gate, status = self._lidar.odometry_gate, self._status()
        record = self._records.setdefault(stream, IncrementRecord(gate))
        if status == FALLBACK:
            record.acquit()
        trial, user = self._trial, self._user
        noise = record.take(
            user.stamp_s,
            innovation.residual,
            innovation.predicted,
            innovation.noise,
            status == GLOBAL,
        )
        is_used = noise is not None and user.correct_by_increment(
            replace(innovation, noise=noise), gate
        )
        if status == GLOBAL:
            trial.conclude(record.is_wrong, record.period_s)
        if record.is_wrong or not trial.trusts:
            return "contradicted by fixes and inertial samples"
        return "" if is_used else "outlier"

    def _T_imu_lidar(self, frame: str) -> Float:
        sensor = self._machine.sensors.get(frame)
        if sensor is None or sensor.link != self._machine.cabin_link:
            raise ConfigError(
                f"estimation: there is odometry of '{frame}', but no such sensor on the cabin"
            )
        return np.asarray(self._T_imu_cabin @ sensor.T_link_sensor)
