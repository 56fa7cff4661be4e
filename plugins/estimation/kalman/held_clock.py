"""When a filter estimates the receiver's clock: in motion, while all innovations are explained."""

from collections import deque

import numpy as np
from executive_plugins.estimation.cholesky import squared_distance
from executive_plugins.estimation.gate.innovation_alarm import binary, chance_limit
from executive_plugins.estimation.inertial.state import VELOCITY
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter

from executive.arrays import Float

_REMEMBERED_S = 20.0  # six fixes of the slowest receivers


class HeldClock:
    """Holds the clock while the prediction or the fixes are in doubt, and for some time after.

    A clock that is late by d moves a fix by the velocity times d: what any other sensor errs along
    the path passes for an offset of the clock. The clock itself does not change with such an error,
    and what is known of it from before is better than what is learnt meanwhile.
    """

    def __init__(self, held_s: float) -> None:
        """Begin without doubt.

        Args:
            held_s: How long the clock is held after the last doubt [s].
        """
        self._held_s, self._doubted_s = held_s, -float("inf")
        self._clocks: deque[tuple[float, float]] = deque()  # times with the clock, both [s]

    def is_held(self, kalman: ErrorStateFilter) -> bool:
        """Return whether the last doubt, or gap in the samples, is too near to learn the clock."""
        return kalman.stamp_s - max(self._doubted_s, kalman.gap_s) < self._held_s

    def remember(self, now_s: float, clock_s: float) -> None:
        """Take the clock at a time at which nothing was in doubt, both [s]."""
        self._clocks.append((now_s, clock_s))
        while self._clocks[0][0] < now_s - _REMEMBERED_S:
            self._clocks.popleft()

    def hold(self, kalman: ErrorStateFilter, since_s: float) -> None:
        """Take back the clock of before an error began, and leave it there.

        Args:
            kalman: The filter.
            since_s: For how long the error may have been there [s].
        """
        now_s = kalman.stamp_s
        if not kalman.holds_clock and self._clocks:
            before = [clock_s for at_s, clock_s in self._clocks if at_s <= now_s - since_s]
            kalman.restore_clock(before[-1] if before else self._clocks[0][1])
        kalman.holds_clock, self._doubted_s = True, now_s


def shows_clock(kalman: ErrorStateFilter, arm_imu: Float, period_s: float) -> bool:
    """Return whether an antenna moves, beyond what chance makes of one at rest.

    A fix tells the clock by the antenna's velocity. Of one at rest only the error of the estimated
    velocity is seen, and a linear filter takes each fix for information by as much: at fifty fixes
    a second, the clock was wrong by seven deviations within a second.

    Args:
        kalman: The filter.
        arm_imu: The antenna in IMU axes [m], shape (3,).
        period_s: Usual time between two fixes [s].
    """
    state = kalman.state
    velocity_imu = state.R_map_imu.T @ state.v_map_imu + np.cross(state.rate, arm_imu)
    covariance = kalman.covariance[VELOCITY, VELOCITY]  # in IMU axes, see `exponential`
    return squared_distance(covariance, velocity_imu) > chance_limit(binary(period_s))
