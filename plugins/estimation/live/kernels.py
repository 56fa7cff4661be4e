"""Propagation and reporting at each inertial sample, compiled into one call.

Between two samples at 100 Hz, other code evicts this code from the processor's caches, and on many
processors from the branch predictor. The time of a call is then determined by the amount of code
and memory that it touches, not by the arithmetic, which takes a microsecond; NumPy calls of half a
microsecond each take twenty. Hence all data is in one block, no array is allocated, and one
function does everything.
"""

import math
from typing import Any

import numpy as np
from executive_plugins.estimation.inertial.strapdown import (
    carry_covariance_into,
    chain,
    multiply,
    turn_into,
)
from executive_plugins.estimation.live.layout import ESTIMATE, LIVE, SAMPLES
from executive_plugins.estimation.live.packed_state import ROW
from numba import from_dtype, njit, types
from numpy.typing import NDArray

from executive.arrays import Float

OUT_OF_RANGE, GAP = -1, -2
_MAX_RATE_RAD_S = 35.0  # 2000 deg/s: the range of a MEMS sensor
_MAX_FORCE_M_S2 = 160.0  # 16 g
_COVARIANCE_PERIOD_S = 0.049  # the covariance grows slowly: one of up to 50 ms ago is reported
_TURN_AHEAD_S = 0.1  # the turn joint's angle is extrapolated by at most this time

Block = NDArray[np.void]
_LIVE, _ROW = from_dtype(LIVE)[::1], from_dtype(ROW)[::1]
_ESTIMATE = from_dtype(ESTIMATE)[::1]
_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
_MATRIX = types.Array(types.float64, 2, "A", readonly=True)
_N = 15


@njit(cache=True)  # type: ignore[untyped-decorator]
def _is_beyond(v: Float, bound: float) -> bool:
    return bool(abs(v[0]) > bound or abs(v[1]) > bound or abs(v[2]) > bound)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _propagate(s: Any, stamp_s: float, rate: Float, force: Float) -> None:
    """Propagate the state to a sample, as `strapdown.advance` does."""
    dt_s = stamp_s - s.stamp_s
    half_s = 0.5 * dt_s
    b = s.gyro_bias
    turn_into(
        half_s * (rate[0] - b[0]), half_s * (rate[1] - b[1]), half_s * (rate[2] - b[2]), s.half_turn
    )
    multiply(s.R, s.half_turn, s.R_middle)
    multiply(s.R_middle, s.half_turn, s.R)
    x, y, z = force[0] - s.accel_bias[0], force[1] - s.accel_bias[1], force[2] - s.accel_bias[2]
    for i in range(3):
        acceleration = s.R_middle[i, 0] * x + s.R_middle[i, 1] * y + s.R_middle[i, 2] * z
        if i == 2:
            acceleration -= s.gravity_m_s2
        v = s.v[i] + dt_s * acceleration
        s.p[i] += half_s * (s.v[i] + v)
        s.v[i] = v
        s.rate[i] = rate[i]
    s.stamp_s = stamp_s


@njit(cache=True)  # type: ignore[untyped-decorator]
def _carry_covariance(s: Any) -> None:
    """Compute the covariance of the sensor's pose, map axes, from that of the last estimate.

    In map axes it does not turn with the body, so that it holds until it is computed anew.
    """
    dt_s = s.stamp_s - s.from_s
    carry_covariance_into(s.from_P, s.from_R, s.from_rate, s.from_force, s.densities, dt_s, s.P)
    turn_into(dt_s * s.from_rate[0], dt_s * s.from_rate[1], dt_s * s.from_rate[2], s.half_turn)
    multiply(s.from_R, s.half_turn, s.R_middle)  # the attitude whose axes its rotations have
    J, P = s.by_pose, np.empty((6, 6))
    for i in range(6):
        for j in range(6):
            J[i, j] = 1.0 if i == j else 0.0
            if i < 3 and j < 3:
                J[i, j] = s.R_middle[i, j]
            P[i, j] = s.P[_pose_index(i), _pose_index(j)]
    _sandwich(J, P, s.half, s.map_covariance)
    s.carried_s = s.stamp_s


@njit(cache=True)  # type: ignore[untyped-decorator]
def _sandwich(J: Float, P: Float, half: Float, after: Float) -> None:
    """Compute J P and J P Jᵀ, shapes (6, 6)."""
    for i in range(6):
        for j in range(6):
            total = 0.0
            for k in range(6):
                total += J[i, k] * P[k, j]
            half[i, j] = total
    for i in range(6):
        for j in range(6):
            total = 0.0
            for k in range(6):
                total += half[i, k] * J[j, k]
            after[i, j] = total


@njit(cache=True)  # type: ignore[untyped-decorator]
def _report_covariance(s: Any, T_map_cabin: Float, after: Float) -> None:
    """Write the covariance of the cabin's pose in its axes, shape (6, 6)."""
    J, T, p = s.by_pose, T_map_cabin, s.p
    a, b, c = T[0, 3] - p[0], T[1, 3] - p[1], T[2, 3] - p[2]
    for i in range(3):
        x, y, z = T[0, i], T[1, i], T[2, i]
        J[i, 0], J[i, 1], J[i, 2] = x, y, z
        J[i, 3], J[i, 4], J[i, 5] = 0.0, 0.0, 0.0
        J[3 + i, 3], J[3 + i, 4], J[3 + i, 5] = x, y, z
        # A rotation θ of the sensor moves the cabin by θ × arm; along an axis, by (arm × axis) θ.
        J[3 + i, 0], J[3 + i, 1], J[3 + i, 2] = b * z - c * y, c * x - a * z, a * y - b * x
    _sandwich(J, s.map_covariance, s.half, after)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _pose_index(i: int) -> int:
    """Return the index of a rotation or position error in the error state, see `state`."""
    return i if i < 3 else i + 3


@njit(cache=True)  # type: ignore[untyped-decorator]
def _place(s: Any, T: Float) -> None:
    """Write the sensor's pose in the map."""
    for i in range(3):
        T[i, 0], T[i, 1], T[i, 2], T[i, 3] = s.R[i, 0], s.R[i, 1], s.R[i, 2], s.p[i]
        T[3, i] = 0.0
    T[3, 3] = 1.0


@njit(cache=True)  # type: ignore[untyped-decorator]
def _report(s: Any, row: Any) -> None:
    """Write the fields of a report, see `BaseState`."""
    row.stamp_s = s.stamp_s
    if not abs(s.stamp_s - s.carried_s) <= _COVARIANCE_PERIOD_S:
        _carry_covariance(s)
    ahead_s = min(_TURN_AHEAD_S, max(-_TURN_AHEAD_S, s.stamp_s - s.turn_s))
    back_rad = -(s.turn_rad + ahead_s * s.turn_rad_s)
    turn_into(back_rad * s.axis[0], back_rad * s.axis[1], back_rad * s.axis[2], s.half_turn)
    for i in range(3):
        for j in range(4):
            s.T_cabin_base[i, j] = (
                s.half_turn[i, 0] * s.T_joint_base[0, j]
                + s.half_turn[i, 1] * s.T_joint_base[1, j]
                + s.half_turn[i, 2] * s.T_joint_base[2, j]
            )
    _place(s, s.T_map_imu)
    T = s.T_imu_cabin
    chain(s.T_map_imu, T, row.T_map_cabin)
    chain(row.T_map_cabin, s.T_cabin_base, row.T_map_base)
    chain(s.T_odom_map, row.T_map_base, row.T_odom_base)
    x, y, z = s.rate[0] - s.gyro_bias[0], s.rate[1] - s.gyro_bias[1], s.rate[2] - s.gyro_bias[2]
    a, b, c = y * T[2, 3] - z * T[1, 3], z * T[0, 3] - x * T[2, 3], x * T[1, 3] - y * T[0, 3]
    for i in range(3):
        row.v_map_cabin[i] = s.v[i] + s.R[i, 0] * a + s.R[i, 1] * b + s.R[i, 2] * c
        row.w_map_cabin_in_cabin[i] = T[0, i] * x + T[1, i] * y + T[2, i] * z
    _report_covariance(s, row.T_map_cabin, row.covariance)


@njit(types.void(_LIVE, _ROW), cache=True)  # type: ignore[untyped-decorator]
def report(live: Block, row: Block) -> None:
    """Write the report of the newest sample.

    Args:
        live: The block, shape (1,), dtype `LIVE`.
        row: Result, shape (1,), dtype `ROW`.
    """
    _report(live[0], row[0])


@njit(types.boolean(_VECTOR, _VECTOR), cache=True)  # type: ignore[untyped-decorator]
def is_beyond_range(rate: Float, force: Float) -> bool:
    """Return whether values are beyond a MEMS sensor's range [rad/s], [m/s²], shape (3,) each."""
    return bool(_is_beyond(rate, _MAX_RATE_RAD_S) or _is_beyond(force, _MAX_FORCE_M_S2))


@njit(types.int64(_LIVE, types.float64, _VECTOR, _VECTOR, _ROW), cache=True)  # type: ignore[untyped-decorator]
def step(live: Block, stamp_s: float, rate: Float, force: Float, row: Block) -> int:
    """Propagate to a sample, store it, and write the report.

    Args:
        live: The block, shape (1,), dtype `LIVE`.
        stamp_s: End of the interval that the sample covers [s].
        rate, force: As measured [rad/s], [m/s²], IMU axes, shape (3,) each; finite.
        row: Result, shape (1,), dtype `ROW`.

    Returns:
        The number of estimates that the smoother's process has written so far. If nothing was done:
        `OUT_OF_RANGE`, or `GAP` if the time since the last sample is too long or negative.
    """
    s = live[0]
    if is_beyond_range(rate, force):
        return OUT_OF_RANGE
    dt_s = stamp_s - s.stamp_s
    if not 0 <= dt_s <= s.gap_s:
        return GAP
    kept = s.samples[s.written % SAMPLES]
    kept.stamp_s = stamp_s
    kept.since_last_s = dt_s
    for i in range(3):
        kept.rate[i] = rate[i]
        kept.force[i] = force[i]
    s.written += 1
    _propagate(s, stamp_s, rate, force)
    _report(s, row[0])
    return int(s.answered)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _correct_odometry(s: Any) -> None:
    """Move the map under the odometry by the sensor's motion in a correction (Nubert 2022, Eq. 11).

    T_odom_map ← T_odom_map · T_before · T_after⁻¹. The paper does this when the satellites come
    back; here it is done at each correction, large or small.
    """
    after, to_before = s.T_map_imu, np.empty((4, 4))
    _place(s, after)
    inverse = np.empty((4, 4))
    for i in range(3):
        for j in range(3):
            inverse[i, j] = after[j, i]
            inverse[3, j] = 0.0
        inverse[i, 3] = -(
            after[0, i] * after[0, 3] + after[1, i] * after[1, 3] + after[2, i] * after[2, 3]
        )
    inverse[3, 3] = 1.0
    chain(s.T_before, inverse, to_before)
    chain(s.T_odom_map, to_before, after)
    for i in range(4):
        for j in range(4):
            s.T_odom_map[i, j] = after[i, j]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _anchor(s: Any, e: Any) -> None:
    """Store an estimate as the origin from which the covariance is propagated."""
    s.from_s = e.sample.stamp_s
    for i in range(3):
        s.from_rate[i] = e.sample.rate[i] - e.gyro_bias[i]
        s.from_force[i] = e.sample.force[i] - e.accel_bias[i]
        for j in range(3):
            s.from_R[i, j] = e.R[i, j]
    for i in range(_N):
        for j in range(_N):
            s.from_P[i, j] = e.P[i, j]
    s.carried_s = -math.inf


@njit(  # type: ignore[untyped-decorator]
    types.void(
        *(_ESTIMATE, types.float64, types.float64, _VECTOR, _VECTOR),
        *(_MATRIX, _VECTOR, _VECTOR, _VECTOR, _VECTOR, _MATRIX, types.int64),
    ),
    cache=True,
)
def write_estimate(  # noqa: PLR0913 - compiled code takes the arrays of a state one by one
    estimate: Block,
    stamp_s: float,
    since_last_s: float,
    rate: Float,
    force: Float,
    R: Float,
    p: Float,
    v: Float,
    gyro_bias: Float,
    accel_bias: Float,
    P: Float,
    mode: int,
) -> None:
    """Write the values of an estimate, shape (1,), dtype `ESTIMATE`; see `packing.pack_into`."""
    e = estimate[0]
    e.sample.stamp_s, e.sample.since_last_s, e.mode = stamp_s, since_last_s, mode
    for i in range(3):
        e.sample.rate[i], e.sample.force[i] = rate[i], force[i]
        e.p[i], e.v[i] = p[i], v[i]
        e.gyro_bias[i], e.accel_bias[i] = gyro_bias[i], accel_bias[i]
        for j in range(3):
            e.R[i, j] = R[i, j]
    for i in range(_N):
        for j in range(_N):
            e.P[i, j] = P[i, j]


@njit(types.boolean(_ESTIMATE), cache=True)  # type: ignore[untyped-decorator]
def has_finite_values(estimate: Block) -> bool:
    """Return whether state and covariance of an estimate are finite, shape (1,)."""
    e, total = estimate[0], 0.0
    for i in range(3):
        # What is not finite times zero is NaN, and so is the sum.
        total += 0.0 * e.p[i] + 0.0 * e.v[i] + 0.0 * e.gyro_bias[i] + 0.0 * e.accel_bias[i]
        for j in range(3):
            total += 0.0 * e.R[i, j]
    for i in range(_N):
        for j in range(_N):
            total += 0.0 * e.P[i, j]
    return total == 0.0


@njit(types.void(_LIVE, _ESTIMATE), cache=True)  # type: ignore[untyped-decorator]
def anchor(live: Block, estimate: Block) -> None:
    """Propagate the covariance from an estimate and keep the state.

    The estimate has shape (1,) and dtype `ESTIMATE`.
    """
    _anchor(live[0], estimate[0])


@njit(types.boolean(_LIVE, _ESTIMATE, types.boolean), cache=True)  # type: ignore[untyped-decorator]
def take(live: Block, estimate: Block, moves_map: bool) -> bool:
    """Replace the state by an estimate, propagated through the newer samples.

    Args:
        live: The block, shape (1,), dtype `LIVE`.
        estimate: The estimate, shape (1,), dtype `ESTIMATE`.
        moves_map: Whether it corrects the state before, so that the pose in the odometry frame
            stays and the map moves.

    Returns:
        Whether the estimate was finite; if not, it is ignored.
    """
    if not has_finite_values(estimate):
        return False
    s, e = live[0], estimate[0]
    _place(s, s.T_before)
    _anchor(s, e)
    s.stamp_s = e.sample.stamp_s
    for i in range(3):
        s.p[i], s.v[i] = e.p[i], e.v[i]
        s.gyro_bias[i], s.accel_bias[i] = e.gyro_bias[i], e.accel_bias[i]
        s.rate[i] = e.sample.rate[i]
        for j in range(3):
            s.R[i, j] = e.R[i, j]
    first = s.written
    oldest = max(s.forgotten, s.written - SAMPLES)
    while first > oldest and s.samples[(first - 1) % SAMPLES].stamp_s > s.stamp_s:
        first -= 1
    for k in range(first, s.written):
        sample = s.samples[k % SAMPLES]
        _propagate(s, sample.stamp_s, sample.rate, sample.force)
    if moves_map:
        _correct_odometry(s)
    return True
