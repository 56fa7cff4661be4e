"""Increments of odometry against the inertial prediction of a graph: which are used, how far."""

from dataclasses import replace

import numpy as np
from executive_plugins.estimation.gate.increment_record import IncrementRecord
from executive_plugins.estimation.gate.measurements import Increment
from executive_plugins.estimation.graph.window import GraphWindow
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import GYRO_BIAS, VELOCITY, InertialState

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import log_so3


class IncrementCheck:
    """Compares increments with the motion between two states of a graph; see `IncrementRecord`."""

    def __init__(self, noise: InertialNoise, gate: float) -> None:
        """Make one without a record.

        Args:
            noise: Noise of the inertial sensor.
            gate: Largest squared Mahalanobis distance of an increment.
        """
        self._noise, self._record = noise, IncrementRecord(gate)

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
        covariance = self._record.take(
            increment.stamp_s, innovation, predicted, increment.covariance, is_tied
        )
        return None if covariance is None else replace(increment, covariance=covariance)

    @property
    def is_wrong(self) -> bool:
        """Whether the odometry is refused by its newest innovations."""
        return self._record.is_wrong

    @property
    def period_s(self) -> float:
        """Usual time between two increments [s]."""
        return self._record.period_s

    def acquit(self) -> None:
        """Use the odometry of a present lean again: without fixes, nothing else holds the state."""
        self._record.acquit()

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
