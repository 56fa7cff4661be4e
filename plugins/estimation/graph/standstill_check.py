"""Measurements of a chassis at rest: when they are used, and their factors."""

import math
from collections.abc import Sequence

import gtsam
import numpy as np
from executive_plugins.estimation.factors import gyro_bias_factor, velocity_factor
from executive_plugins.estimation.gate.measurements import Standstill
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.window import GraphWindow
from executive_plugins.estimation.inertial.measurement_models import standstill_residual
from executive_plugins.estimation.inertial.state import InertialState

from executive.arrays import Float
from executive.geometry.rotation import skew

_STANDING = "standing"


class StandstillCheck:
    """Compares measurements of a chassis at rest with the estimate.

    A chassis that drives smoothly looks as if it were at rest. On a simulated drive with 0.1 m/s²
    the detector was wrong for seconds, and the graph, whose fixes were then refused by its own
    gate, stayed behind by metres.
    """

    def __init__(self, settings: SmootherSettings) -> None:
        self._settings = settings
        self._contradicted_s = -np.inf

    def take(
        self,
        standing: Standstill,
        state: InertialState,
        P: Float,
        windows: Sequence[GraphWindow],
    ) -> None:
        """Add a standstill to graphs, unless the estimate contradicts it.

        After a contradiction, the standstills shortly before it are removed as well.

        Args:
            standing: The measurement.
            state: The estimate at its time.
            P: Covariance of the estimate's error, shape (15, 15).
            windows: The graphs.
        """
        stamp_s = standing.stamp_s
        if self.contradicts(standing, state, P):
            for window in windows:
                window.take_back(_STANDING, stamp_s - self._settings.standing_doubt_s)
        if self.is_accepted(stamp_s):
            for window in windows:
                node = window.node_at(stamp_s)
                window.add(_STANDING, stamp_s, self.factors(node, standing, state))

    def contradicts(self, standing: Standstill, state: InertialState, P: Float) -> bool:
        """Return whether the estimate, with its covariance (15, 15), shows motion."""
        residual, H = standstill_residual(state, standing.arm_imu)
        S = H @ P @ H.T + self._velocity_std_m_s(standing) ** 2 * np.eye(3)
        if residual @ np.linalg.solve(S, residual) <= self._settings.standing_gate:
            return False
        self._contradicted_s = standing.stamp_s
        return True

    def is_accepted(self, stamp_s: float) -> bool:
        """Return whether the last contradiction is long enough ago."""
        return stamp_s - self._contradicted_s >= self._settings.standing_doubt_s

    def factors(
        self, node: int, standing: Standstill, state: InertialState
    ) -> list[gtsam.NonlinearFactor]:
        """Return the factors of a chassis at rest.

        The velocity of a point on the turn axis, v + R (ω × l), is zero; R and ω are taken from the
        present estimate.
        """
        speed = state.R_map_imu @ skew(state.rate) @ standing.arm_imu
        made = [velocity_factor(node, -speed, self._velocity_std_m_s(standing))]
        if standing.rate_imu is not None:
            bias = state.sample.rate - standing.rate_imu
            std_rad_s = math.hypot(self._settings.standing_rate_std_rad_s, standing.sway_rad_s)
            made.append(gyro_bias_factor(node, bias, std_rad_s))
        return made

    def _velocity_std_m_s(self, standing: Standstill) -> float:
        return math.hypot(self._settings.standing_velocity_std_m_s, standing.sway_m_s)
