"""Solutions of one window that differ in heading, joined to one state and covariance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.exponential import left_jacobian, moved_far
from executive_plugins.estimation.inertial.state import (
    ACCEL_BIAS,
    DIMENSION,
    GYRO_BIAS,
    POSITION,
    ROTATION,
    VELOCITY,
    InertialState,
)
from executive_plugins.estimation.start.found import Found
from executive_plugins.estimation.start.wide_heading import heading_std, with_heading_std

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
    hypotheses: Sequence[Hypothesis],
    held: Sequence[tuple[float, float]],
    max_heading_std_rad: float,
) -> tuple[Found, int, float]:
    """Join hypotheses.

    Args:
        hypotheses: At least one.
        held: Headings that the likeliest one was turned by and held at [rad], with the cost of the
            best solution there over its own. Where a body hardly moves, the noise of its estimated
            motion looks as if it told the heading; the cost elsewhere shows that it does not.
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
        J = np.linalg.inv(moved_far(best.state, error)[1])  # from its errors to the best one's
        P += weight * (J @ one.covariance @ J.T + np.outer(error, error))
        cross += weight * (J @ one.clock.cross + late_s * error)
        variance += weight * (one.clock.std_s**2 + late_s**2)
    std_rad = max(heading_std(best.state, best.covariance), _spread(held))
    is_known = len(kept) == 1 and std_rad <= max_heading_std_rad
    bound = with_heading_std(best.state, P, max(heading_std(best.state, P), std_rad))
    clock = ClockOffset(best.clock.offset_s, float(np.sqrt(variance)), bound @ cross)
    found = Found(best.state, bound @ P @ bound.T, is_known, clock, best.fix_scale)
    return found, len(kept), std_rad


def _spread(held: Sequence[tuple[float, float]]) -> float:
    """Return the standard deviation of a heading about the likeliest one by what others cost."""
    turns = np.array([0.0, *(turn_rad for turn_rad, _ in held)])
    costs = np.array([0.0, *(cost for _, cost in held)])
    weights = np.exp(costs.min() - costs)
    return float(np.sqrt(weights @ turns**2 / weights.sum()))


def _differ(a: Hypothesis, b: Hypothesis) -> bool:
    yaws = yaw_of(a.state.R_map_imu), yaw_of(b.state.R_map_imu)
    return bool(abs(wrap_angle(yaws[0] - yaws[1])) > _SAME_RAD)


def _difference(origin: InertialState, other: InertialState) -> Float:
    """Return the error of one state if another is true, shape (15,); see `exponential`.

    Two headings put the carrier of one antenna on a circle: as errors of the group, both are the
    same motion by different angles, and their joint covariance knows the antenna.
    """
    error = np.zeros(DIMENSION)
    R, error[ROTATION] = origin.R_map_imu, log_so3(origin.R_map_imu.T @ other.R_map_imu)
    along = R @ left_jacobian(error[ROTATION]) @ R.T
    error[VELOCITY] = np.linalg.solve(along, other.v_map_imu - origin.v_map_imu)
    error[POSITION] = np.linalg.solve(along, other.p_map_imu - origin.p_map_imu)
    error[GYRO_BIAS] = other.gyro_bias - origin.gyro_bias
    error[ACCEL_BIAS] = other.accel_bias - origin.accel_bias
    return error
