"""Comparison of a fix with the estimate of a window and with lidar odometry."""

import numpy as np
from executive_plugins.estimation.gate.gnss_gate import Compared
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.graph.lidar_chain import LidarChain
from executive_plugins.estimation.graph.window import GraphWindow
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    InertialState,
    carry_covariance,
    error_transition,
)
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.fix_residual import fix_residual

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform

_SCAN_S = 0.3  # longest time between a fix and the scan whose odometry it is compared with


def compared(
    fix: Fix, window: GraphWindow, chain: LidarChain | None, noise: InertialNoise
) -> Compared:
    """Compare a fix with the estimate of a window, and with the odometry alone.

    Without odometry or a recent scan, the estimate takes the place of the odometry.
    """
    state, P = predicted(window, fix.stamp_s, noise)
    clock = _clock_at(window, state)
    kalman = ErrorStateFilter(state, P, noise, clock)
    residual, H, by_clock, covariance = fix_residual(kalman, fix, fix.late_s)
    known = kalman.predicted(H, by_clock)
    S, late_m = known + covariance, np.zeros(3)
    if by_clock is not None:
        late_m = -by_clock * (clock.offset_s - fix.late_s)
    scan = None if chain is None else chain.before(fix.stamp_s, _SCAN_S)
    if scan is None or scan[0] <= window.oldest_s:
        slack_m = 3 * float(np.sqrt(np.linalg.eigvalsh(known)[-1]))
        p_antenna = fix.p_map_antenna + late_m - residual
        return Compared(fix, residual, S, p_antenna, np.eye(3), False, slack_m, late_m)
    T_chain_imu, R_map_chain = _reckoned(window, state, *scan)
    p_chain = transform(T_chain_imu, fix.arm_imu)
    return Compared(fix, residual, S, p_chain, R_map_chain, True, late_m=late_m)


def _clock_at(window: GraphWindow, state: InertialState) -> ClockOffset:
    """Return the receiver's clock of a window, with what it shares with a state's error."""
    clock, ahead_s = window.clock, state.stamp_s - window.newest_s
    if clock.is_known or ahead_s <= 0:
        return clock
    cross = error_transition(state, ahead_s) @ clock.cross
    return ClockOffset(clock.offset_s, clock.std_s, cross)


def predicted(
    window: GraphWindow, stamp_s: float, noise: InertialNoise
) -> tuple[InertialState, Float]:
    """Return the estimate of a window at a time [s], and its covariance (15, 15).

    The covariance is that of the newest node, propagated over the time since.
    """
    state, ahead_s = window.state_at(stamp_s), stamp_s - window.newest_s
    if ahead_s <= 0:
        return state, window.covariance
    return state, carry_covariance(state, window.covariance, noise, ahead_s)


def _reckoned(
    window: GraphWindow, state: InertialState, scan_s: float, T_chain_scan: Float
) -> tuple[Float, Float]:
    """Return the IMU in the lidar chain by odometry, and the chain's attitude in the map.

    The pose is propagated from the last scan. The shapes are (4, 4) and (3, 3).
    """
    at_scan = window.state_at(scan_s)
    T_map_scan = pose(at_scan.R_map_imu, at_scan.p_map_imu)
    T_scan_imu = inverse(T_map_scan) @ pose(state.R_map_imu, state.p_map_imu)
    return T_chain_scan @ T_scan_imu, T_map_scan[:3, :3] @ T_chain_scan[:3, :3].T
