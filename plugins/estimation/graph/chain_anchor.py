"""The lidar chain's pose in the map during an outage, for the paper's fallback graph."""

import numpy as np
from executive_plugins.estimation.factors import pose_factor
from executive_plugins.estimation.gate.measurements import Increment
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.window import GraphWindow

from executive.arrays import Float
from executive.geometry.pose import inverse, pose


class ChainAnchor:
    """T_map_chain of Nubert 2022, Eq. (10): it makes global poses of the lidar chain's poses."""

    def __init__(self, settings: SmootherSettings) -> None:
        self._settings = settings
        self._T_map_chain: Float | None = None

    def clear(self) -> None:
        """Forget the anchor; the next increment sets a new one."""
        self._T_map_chain = None

    def place(self, window: GraphWindow, scan_s: float, T_chain_imu: Float) -> Float:
        """Set the anchor by the estimate at a scan [s] and the chain's pose there; return it."""
        state = window.state_at(scan_s)
        T_map_chain = pose(state.R_map_imu, state.p_map_imu) @ inverse(T_chain_imu)
        self._T_map_chain = T_map_chain
        return T_map_chain

    def add_pose(self, fallback: GraphWindow, increment: Increment, T_chain_imu: Float) -> None:
        """Add the global pose T_map_chain · T_chain_imu at the end of an increment.

        An increment that begins before the window is ignored.
        """
        if increment.from_s <= fallback.oldest_s:
            return
        T_map_chain = self._T_map_chain
        if T_map_chain is None:
            T_chain_before = T_chain_imu @ inverse(increment.T_from_to)
            T_map_chain = self.place(fallback, increment.from_s, T_chain_before)
        T_map_imu = T_map_chain @ T_chain_imu
        node = fallback.node_at(increment.stamp_s)
        factor = pose_factor(node, T_map_imu, self._covariance(T_map_imu[:3, :3]))
        fallback.add("lidar", increment.stamp_s, [factor])

    def _covariance(self, R_map_imu: Float) -> Float:
        """Return the covariance of a pose as (rotation, translation) in IMU axes, shape (6, 6)."""
        settings = self._settings
        level, yaw = settings.fallback_level_std_rad**2, settings.fallback_yaw_std_rad**2
        P = settings.fallback_position_std_m**2 * np.eye(6)
        P[:3, :3] = R_map_imu.T @ np.diag([level, level, yaw]) @ R_map_imu
        return P
