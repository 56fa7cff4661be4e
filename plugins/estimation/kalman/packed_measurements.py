"""Measurements beside what a packed filter predicts of them, in compiled form."""

import math

import numpy as np
from executive_plugins.estimation.inertial.measurement_models import write_antenna, write_standstill
from executive_plugins.estimation.kalman.bent_innovation import add_bend
from executive_plugins.estimation.kalman.compiled_correction import project_into
from executive_plugins.estimation.kalman.layout import FILTER_TYPE, Block, matrix
from executive_plugins.estimation.kalman.packed_correction import (
    correct_by,
    joint_covariance,
    shown,
)
from executive_plugins.estimation.kalman.packed_prediction import acceleration_of, steady_rate
from numba import njit, types

from executive.arrays import Float

_REAL = types.float64
_VECTOR = types.Array(_REAL, 1, "A", readonly=True)
_MATRIX = types.Array(_REAL, 2, "A", readonly=True)
_N = 15


@njit(cache=True)  # type: ignore[untyped-decorator]
def _blank(s: np.record) -> Float:
    """Return the derivative of a measurement of three values by the errors, zero, (3, 15 + k)."""
    for i in range(3 * (_N + s.companions)):
        s.H[i] = 0.0
    H: Float = matrix(s.H, 3, _N + s.companions)
    return H


@njit(cache=True)  # type: ignore[untyped-decorator]
def compare_fix(
    s: np.record, arm: Float, p_map_antenna: Float, covariance: Float, late_s: float
) -> None:
    """Do what `compare` does, for callers in compiled code."""
    _compare_fix(s, arm, p_map_antenna, covariance, late_s)
    joint = joint_covariance(s)
    project_into(matrix(s.H, 3, _N + s.companions), joint, matrix(s.predicted, 3, 3))
    add_bend(s, joint)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _compare_fix(
    s: np.record, arm: Float, p_map_antenna: Float, covariance: Float, late_s: float
) -> None:
    """Write residual, derivative and noise of a fix."""
    H, noise, residual = _blank(s), matrix(s.noise, 3, 3), s.residual[:3]
    write_antenna(s.R, s.p, arm, p_map_antenna, residual, H[:, :_N])
    for i in range(3):
        for j in range(3):
            noise[i, j] = covariance[i, j]
    if s.clocks == 0 or s.own[0, 0] == 0.0:
        return
    velocity, acceleration = np.empty(3), np.empty(3)
    shown(s, s.v, velocity)
    acceleration_of(s, acceleration)
    rate, turned, bend2 = np.empty(3), np.empty(3), 0.0
    steady_rate(s, rate)
    for i in range(3):
        k, m = (i + 1) % 3, (i + 2) % 3
        turned[i] = rate[k] * arm[m] - rate[m] * arm[k]
        bend2 += (0.5 * s.own[0, 0] * acceleration[i]) ** 2
    for i in range(3):
        back = s.R[i, 0] * turned[0] + s.R[i, 1] * turned[1] + s.R[i, 2] * turned[2]
        H[i, _N] = -(velocity[i] + back)
        residual[i] -= H[i, _N] * (s.clock_s - late_s)
        noise[i, i] += bend2


@njit(types.void(FILTER_TYPE, _VECTOR, _VECTOR, _MATRIX, _REAL), cache=True)  # type: ignore[untyped-decorator]
def compare(
    block: Block, arm: Float, p_map_antenna: Float, covariance: Float, late_s: float
) -> None:
    """Write a fix beside its prediction into a filter, see `fix_residual`.

    Args:
        block: The filter, shape (1,), dtype `FILTER`; residual, H, noise and the covariance of
            the prediction are written.
        arm: The antenna in IMU axes [m], shape (3,).
        p_map_antenna: As measured [m], shape (3,).
        covariance: Of that position [m²], shape (3, 3).
        late_s: By how much its stamp was thought to be late when it was queued [s].
    """
    compare_fix(block[0], arm, p_map_antenna, covariance, late_s)


@njit(types.boolean(FILTER_TYPE, _REAL), cache=True)  # type: ignore[untyped-decorator]
def correct_by_compared(block: Block, gate: float) -> bool:
    """Correct by the fix that was compared last; see `correct`."""
    return bool(correct_by(block[0], 3, gate))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _correct_evenly(s: np.record, std: float, gate: float) -> bool:
    """Correct by three values that are known equally well, with a standard deviation."""
    noise = matrix(s.noise, 3, 3)
    for i in range(3):
        for j in range(3):
            noise[i, j] = std**2 if i == j else 0.0
    return bool(correct_by(s, 3, gate))


@njit(types.boolean(FILTER_TYPE, _MATRIX, _VECTOR, *[_REAL] * 5), cache=True)  # type: ignore[untyped-decorator]
def correct_by_standstill(  # noqa: PLR0913 - compiled code takes the values of a record one by one
    block: Block,
    T_imu_cabin: Float,
    rate_cabin: Float,
    velocity_std_m_s: float,
    rate_std_rad_s: float,
    sway_m_s: float,
    sway_rad_s: float,
    gate: float,
) -> bool:
    """Correct by a chassis at rest: by the turn axis, and by the rate on it unless that is large.

    Args:
        block: The filter, shape (1,), dtype `FILTER`.
        T_imu_cabin: The cabin, whose origin is on the turn axis, in the IMU, shape (4, 4).
        rate_cabin: Angular velocity of the cabin on the chassis [rad/s], cabin axes, shape (3,).
        velocity_std_m_s: Standard deviation of the velocity along an axis [m/s].
        rate_std_rad_s: That of the angular velocity about an axis [rad/s]. Larger rates are not
            used: differentiated encoder readings are accurate at rest only.
        sway_m_s: Standard deviation of the velocity by a sway of the chassis [m/s].
        sway_rad_s: That of the angular velocity [rad/s].
        gate: Largest squared Mahalanobis distance that is accepted.

    Returns:
        Whether the velocity was within the gate and was used.
    """
    s, T, w = block[0], T_imu_cabin, rate_cabin
    rate = s.sample.rate - s.gyro_bias
    write_standstill(s.R, s.v, rate, T[:3, 3], s.residual[:3], _blank(s)[:, :_N])
    if not _correct_evenly(s, math.hypot(velocity_std_m_s, sway_m_s), gate):
        return False
    if math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) < rate_std_rad_s:
        H = _blank(s)
        for i in range(3):
            H[i, 9 + i] = -1.0
            measured = T[i, 0] * w[0] + T[i, 1] * w[1] + T[i, 2] * w[2]
            s.residual[i] = measured - (s.sample.rate[i] - s.gyro_bias[i])
        _correct_evenly(s, math.hypot(rate_std_rad_s, sway_rad_s), gate)
    return True
