"""Increments of odometry against the inertial prediction: which are used, and how far."""

from dataclasses import replace

import numpy as np
from executive_plugins.estimation.cholesky import squared_distance
from executive_plugins.estimation.gate.innovation_alarm import InnovationAlarm
from executive_plugins.estimation.gate.innovation_bias import InnovationBias
from executive_plugins.estimation.gate.innovation_scale import InnovationScale
from executive_plugins.estimation.gate.measurements import Increment
from executive_plugins.estimation.gate.stream_period import StreamPeriod
from executive_plugins.estimation.graph.window import GraphWindow
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import GYRO_BIAS, VELOCITY, InertialState

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import log_so3


class IncrementCheck:
    """Refuses increments that the inertial samples contradict, and scales the others' covariance.

    Odometry that has lost its scene stands still or jumps, and says nothing of it. The inertial
    sensor is the witness: over an increment, it errs by the velocity's error only, which good fixes
    keep small, and which grows without them. Odometry that drifts disagrees a little each time;
    there, the factor by which it does so is applied to its covariance. Where fixes hold the
    prediction, increments that lean to one side are no noise, and are refused: with a way that is
    too long by half, they would draw the state along until the fixes counted as outliers. Fixes
    that drift make increments lean as well, once they have drawn the state along, but contradict it
    before: who is refused is decided when a lean begins, and holds until it has ended.
    """

    def __init__(self, noise: InertialNoise, gate: float) -> None:
        """Make one without a record.

        Args:
            noise: Noise of the inertial sensor.
            gate: Largest squared Mahalanobis distance of an increment.
        """
        self._noise, self._gate = noise, gate
        self._scale, self._alarm = InnovationScale(6), InnovationAlarm(6)
        self._bias, self._period = InnovationBias(6), StreamPeriod()
        self._leans = self._is_wrong = False

    def admitted(
        self, increment: Increment, window: GraphWindow, is_tied: bool
    ) -> Increment | None:
        """Return an increment with a covariance that its record explains; None to refuse it.

        Args:
            increment: The increment.
            window: The graph that predicts it.
            is_tied: Whether fixes hold that prediction, and agree with it.
        """
        first, last = window.state_at(increment.from_s), window.state_at(increment.stamp_s)
        T_first = pose(first.R_map_imu, first.p_map_imu)
        T = inverse(T_first) @ pose(last.R_map_imu, last.p_map_imu)
        turn = log_so3(T[:3, :3].T @ increment.T_from_to[:3, :3])
        shift = T[:3, :3].T @ (increment.T_from_to[:3, 3] - T[:3, 3])
        innovation = np.concatenate([turn, shift])
        predicted = self._predicted(window.covariance, last, increment.stamp_s - increment.from_s)
        self._period.add(increment.stamp_s)
        known = predicted + self._scale.factor() * increment.covariance
        self._alarm.add(innovation, known, self._gate, self._period.period_s)
        self._bias.add(innovation, known, self._period.period_s)
        self._scale.add(innovation, predicted, increment.covariance)
        if self._judged(is_tied):
            return None
        covariance = self._scale.factor() * increment.covariance
        if not squared_distance(predicted + covariance, innovation) <= self._gate:
            return None
        return replace(increment, covariance=covariance)

    def acquit(self) -> None:
        """Use the odometry of a present lean again: without fixes, nothing else holds the state."""
        self._is_wrong = False

    def _judged(self, is_tied: bool) -> bool:
        """Return whether the odometry is wrong, by its newest innovations."""
        leans = self._alarm.is_raised or self._bias.is_biased
        if leans != self._leans:
            self._leans, self._is_wrong = leans, leans and is_tied
        return self._is_wrong

    def _predicted(self, P: Float, last: InertialState, over_s: float) -> Float:
        """Return the covariance of the inertial motion over a time, in the later axes, (6, 6).

        Args:
            P: Covariance of the newest state's error, shape (15, 15).
            last: The state at the end.
            over_s: The time [s].
        """
        noise, R = self._noise, last.R_map_imu
        predicted = np.zeros((6, 6))
        predicted[:3, :3] = over_s**2 * P[GYRO_BIAS, GYRO_BIAS]
        predicted[:3, :3] += over_s * noise.gyro_density**2 * np.eye(3)
        predicted[3:, 3:] = over_s**2 * R.T @ P[VELOCITY, VELOCITY] @ R
        predicted[3:, 3:] += over_s**3 / 3 * noise.accel_density**2 * np.eye(3)
        return predicted
