"""Solutions of one window that differ in heading, joined to one state and covariance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.estimation.inertial.state import (
    ACCEL_BIAS,
    DIMENSION,
    GYRO_BIAS,
    POSITION,
    ROTATION,
    VELOCITY,
    InertialState,
)
from executive_plugins.estimation.start.found import ClockOffset, Found
from executive_plugins.estimation.start.wide_heading import bounded, heading_std

from executive.arrays import Float
from executive.geometry.rotation import log_so3, wrap_angle, yaw_of

# Two solutions are two hypotheses if they differ by more than this; the worse one is refuted if
# the data are e⁷ = 1,100 times less likely under it.
_SAME_RAD = 0.3
_REFUTED = 7.0


@dataclass(frozen=True, slots=True, eq=False)
class Hypothesis:
    """One solution.

    Attributes:
        cost: Minus the logarithm of its likelihood.
        state: The newest state.
        covariance: Of its error, shape (15, 15).
        clock: The receiver's clock.
        fix_scale: Factor on the fixes' declared variance that explains the residuals, at least 1.
    """

    cost: float
    state: InertialState
    covariance: Float
    clock: ClockOffset
    fix_scale: float


def most_likely(
    hypotheses: Sequence[Hypothesis], max_heading_std_rad: float
) -> tuple[Found, int, float]:
    """Join hypotheses.

    Args:
        hypotheses: At least one.
        max_heading_std_rad: Largest standard deviation of a heading that is known [rad].

    Returns:
        The likeliest state, whose covariance holds the others that are not refuted; the number of
        headings that are not refuted; and the standard deviation of the likeliest heading [rad].
    """
    ordered = sorted(hypotheses, key=lambda one: one.cost)
    best, kept = ordered[0], [ordered[0]]
    for other in ordered[1:]:
        if other.cost - best.cost < _REFUTED and all(_differ(other, one) for one in kept):
            kept.append(other)
    weights = np.exp([best.cost - one.cost for one in kept])
    weights /= weights.sum()
    P, cross, variance = np.zeros((DIMENSION, DIMENSION)), np.zeros(DIMENSION), 0.0
    for weight, one in zip(weights, kept, strict=True):
        error, late_s = _difference(best.state, one.state), one.clock.offset_s - best.clock.offset_s
        P += weight * (one.covariance + np.outer(error, error))
        cross += weight * (one.clock.cross + late_s * error)
        variance += weight * (one.clock.std_s**2 + late_s**2)
    std_rad = heading_std(best.state, best.covariance)
    is_known = len(kept) == 1 and std_rad <= max_heading_std_rad
    bound = bounded(best.state, P)
    clock = ClockOffset(best.clock.offset_s, float(np.sqrt(variance)), bound @ cross)
    found = Found(best.state, bound @ P @ bound.T, is_known, clock, best.fix_scale)
    return found, len(kept), std_rad


def _differ(a: Hypothesis, b: Hypothesis) -> bool:
    yaws = yaw_of(a.state.R_map_imu), yaw_of(b.state.R_map_imu)
    return bool(abs(wrap_angle(yaws[0] - yaws[1])) > _SAME_RAD)


def _difference(origin: InertialState, other: InertialState) -> Float:
    """Return the error of one state if another is true, shape (15,)."""
    error = np.zeros(DIMENSION)
    error[ROTATION] = log_so3(origin.R_map_imu.T @ other.R_map_imu)
    error[VELOCITY] = other.v_map_imu - origin.v_map_imu
    error[POSITION] = other.p_map_imu - origin.p_map_imu
    error[GYRO_BIAS] = other.gyro_bias - origin.gyro_bias
    error[ACCEL_BIAS] = other.accel_bias - origin.accel_bias
    return error
