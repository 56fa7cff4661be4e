"""The correction of a packed filter: its state, its companions and their covariance."""

import numpy as np
from executive_plugins.estimation.inertial.exponential import linearise, move, turn_along
from executive_plugins.estimation.inertial.strapdown import multiply, turn_into
from executive_plugins.estimation.kalman.compiled_correction import (
    consider_into,
    correct_into,
    project_into,
)
from executive_plugins.estimation.kalman.layout import FILTER_TYPE, Block, matrix
from executive_plugins.estimation.kalman.packed_prediction import (
    SAMPLES_TYPE,
    acceleration_of,
    follow_samples,
)
from executive_plugins.estimation.live.layout import ESTIMATE
from numba import from_dtype, njit, types

from executive.arrays import Float

_REAL, _INT = types.float64, types.int64
_VECTOR = types.Array(_REAL, 1, "A", readonly=True)
_MATRIX = types.Array(_REAL, 2, "A", readonly=True)
_ESTIMATE = from_dtype(ESTIMATE)[::1]
_N = 15


@njit(cache=True)  # type: ignore[untyped-decorator]
def joint_covariance(s: np.record) -> Float:
    """Return the covariance of the errors of state and companions, (15 + k, 15 + k)."""
    k = s.companions
    joint: Float = s.P[:] if k == 0 else matrix(s.joint, _N + k, _N + k)
    if k == 0:
        return joint
    for i in range(_N):
        for j in range(_N):
            joint[i, j] = s.P[i, j]
        for j in range(k):
            joint[i, _N + j] = joint[_N + j, i] = s.cross[i, j]
    for i in range(k):
        for j in range(k):
            joint[_N + i, _N + j] = s.own[i, j]
    return joint


@njit(cache=True)  # type: ignore[untyped-decorator]
def _split(s: np.record, joint: Float) -> None:
    """Keep the covariance of the errors of state and companions, if it is not kept already."""
    k = s.companions
    if k == 0:
        return
    for i in range(_N):
        for j in range(_N):
            s.P[i, j] = joint[i, j]
        for j in range(k):
            s.cross[i, j] = joint[i, _N + j]
    for i in range(k):
        for j in range(k):
            s.own[i, j] = joint[_N + i, _N + j]


@njit(cache=True)  # type: ignore[untyped-decorator]
def shown(s: np.record, velocity: Float, after: Float) -> None:
    """Write a velocity without what may be its own error, shape (3,) [m/s].

    The error of a body at rest would tell of the clock at each fix. Source: the estimate of
    James and Stein 1961, which shrinks towards zero.
    """
    v, variance = velocity, s.P[3, 3] + s.P[4, 4] + s.P[5, 5]
    square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
    share = max(0.0, 1.0 - variance / max(square, 1e-12))
    for i in range(3):
        after[i] = share * v[i]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _shift(s: np.record, after: Float) -> None:
    """Write the change of a state over time, as an error per second, shape (15,)."""
    after[:] = 0.0
    for i in range(3):
        after[i] = s.sample.rate[i] - s.gyro_bias[i]
    acceleration_of(s, after[3:6])
    after[6:9] = s.v


@njit(cache=True)  # type: ignore[untyped-decorator]
def _follow_shift(s: np.record, before: Float, J: Float) -> None:
    """Keep the state at the receiver's time where it was when a correction changes the motion.

    A clock that is late by more, with a state that is later by as much, explains every fix as
    well as before unless the motion changes. The correlations of the clock's error hold the
    motion of the state before the correction. Left so, each correction of the velocity, mere
    noise, would tell of the clock, as with any direction that linearisations at differing
    estimates make observable (Huang 2010, observability-based rules).
    """
    change, clock2 = np.empty(_N), s.own[0, 0]
    _shift(s, change)
    for one in (before, change):
        shown(s, one[6:9].copy(), one[6:9])
    for i in range(_N):
        for j in range(_N):
            change[i] -= J[i, j] * before[j]
    for i in range(_N):
        for j in range(_N):
            s.P[i, j] += change[i] * s.cross[j, 0]
            s.P[i, j] += change[j] * s.cross[i, 0]
            s.P[i, j] += clock2 * (change[i] * change[j])
    for i in range(_N):
        for j in range(s.companions):
            s.cross[i, j] += change[i] * s.own[0, j]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _move_state(s: np.record, error: Float, J: Float) -> None:
    """Apply a correction to the state; write the derivative of what is left of its error."""
    after = s.vectors_after[:]
    move(s.R, s.p, s.v, s.gyro_bias, s.accel_bias, error, J, s.R_after[:], after)
    for i in range(3):
        s.p[i], s.v[i] = after[0, i], after[1, i]
        s.gyro_bias[i], s.accel_bias[i] = after[2, i], after[3, i]
        for j in range(3):
            s.R[i, j] = s.R_after[i, j]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _move_companions(s: np.record, error: Float, J: Float) -> None:
    """Apply a correction to clock and clone, which turns the clone's position along.

    Args:
        s: The filter.
        error: Of the companions, shape (k,).
        J: Result, the derivative of what is left of their error by it, shape (k, k).
    """
    k, c = s.companions, s.clocks
    for i in range(k):
        for j in range(k):
            J[i, j] = 1.0 if i == j else 0.0
    if c:
        s.clock_s += error[0]
    if k == c:
        return
    turn, shift, by_self, R = error[c : c + 3], error[c + 3 :], J[c + 3 :, c + 3 :], s.R_after
    turn_along(s.clone_R, turn, shift, by_self, J[c + 3 :, c : c + 3], J[c : c + 3, c : c + 3])
    turn_into(turn[0], turn[1], turn[2], R)
    multiply(s.clone_R.copy(), R, s.clone_R)
    for i in range(3):
        for j in range(3):
            s.clone_p[i] += by_self[i, j] * shift[j]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _take(s: np.record, P: Float, error: Float) -> None:
    """Apply a correction with the covariance after it, of 15 + k dimensions."""
    n = len(error)
    J, before = matrix(s.moved, n, n), np.empty(_N)
    joint = s.P[:] if n == _N else matrix(s.joint, n, n)
    for i in range(_N):
        for j in range(_N, n):
            J[i, j] = J[j, i] = 0.0
    if s.clocks:
        _shift(s, before)
    _move_state(s, error[:_N], J[:_N, :_N])
    _move_companions(s, error[_N:], J[_N:, _N:])
    project_into(J, P, joint)
    _split(s, joint)
    if s.clocks:
        _follow_shift(s, before, J)


@njit(cache=True)  # type: ignore[untyped-decorator]
def correct_by(s: np.record, m: int, gate: float) -> bool:
    """Correct by the measurement of m values that `residual`, `H` and `noise` of a filter hold.

    Returns:
        Whether it was within the gate and was used. The squared distance is `distance2`.
    """
    n = _N + s.companions
    P, H, noise = joint_covariance(s), matrix(s.H, m, n), matrix(s.noise, m, m)
    W, L, after = matrix(s.W, m, n + 1), matrix(s.L, m, m), matrix(s.after, n, n)
    residual, error = s.residual[:m], s.error[:n]
    distance2: float = correct_into(P, H, residual, noise, gate, W, L, after, error)
    s.distance2 = distance2
    if not distance2 <= gate:
        return False
    if s.clocks and s.holds_clock:
        consider_into(P, H, residual, noise, _N, W, L, after, error)
    _take(s, after, error)
    return True


@njit(types.boolean(FILTER_TYPE, _VECTOR, _MATRIX, _MATRIX, _REAL), cache=True)  # type: ignore[untyped-decorator]
def correct(block: Block, residual: Float, H: Float, noise: Float, gate: float) -> bool:
    """Correct by measured − predicted = H · error + noise.

    Args:
        block: The filter, shape (1,), dtype `FILTER`.
        residual: Shape (m,), m ≤ 6.
        H: Derivative by the errors of state and companions, shape (m, 15 + k).
        noise: Covariance of the measurement, shape (m, m).
        gate: Largest squared Mahalanobis distance that is accepted.

    Returns:
        Whether the measurement was within the gate and was used.
    """
    s, (m, n) = block[0], H.shape
    s.residual[:m] = residual
    matrix(s.H, m, n)[:, :] = H
    matrix(s.noise, m, m)[:, :] = noise
    return bool(correct_by(s, m, gate))


@njit(types.void(FILTER_TYPE, types.float64[:, ::1]), cache=True)  # type: ignore[untyped-decorator]
def write_joint_covariance(block: Block, after: Float) -> None:
    """Write the covariance of the errors of state and companions, (15 + k, 15 + k)."""
    after[:, :] = joint_covariance(block[0])


@njit(cache=True)  # type: ignore[untyped-decorator]
def _report(s: np.record, e: np.record) -> None:
    """Write the state of a filter into an estimate, with what the fixes err slowly."""
    e.sample.stamp_s, e.sample.since_last_s = s.sample.stamp_s, s.sample.since_last_s
    for i in range(3):
        e.sample.rate[i], e.sample.force[i] = s.sample.rate[i], s.sample.force[i]
        e.p[i], e.v[i] = s.p[i], s.v[i]
        e.gyro_bias[i], e.accel_bias[i] = s.gyro_bias[i], s.accel_bias[i]
        for j in range(3):
            e.R[i, j] = s.R[i, j]
    linearise(s.R, s.P, e.P[:])
    for i in range(3):
        e.P[6 + i, 6 + i] += s.slow_m[i] * s.slow_m[i]


@njit(types.void(FILTER_TYPE, _ESTIMATE), cache=True)  # type: ignore[untyped-decorator]
def write_report(block: Block, estimate: Block) -> None:
    """Write the state with its covariance in map axes, shape (1,), dtype `ESTIMATE`."""
    _report(block[0], estimate[0])


@njit(types.int64(FILTER_TYPE, SAMPLES_TYPE, _INT, _INT, _REAL, _ESTIMATE), cache=True)  # type: ignore[untyped-decorator]
def report_until(
    block: Block, ring: Block, first: int, end: int, until_s: float, estimate: Block
) -> int:
    """Do what `predict_until` and then `write_report` do."""
    first = follow_samples(block[0], ring, first, end, until_s)
    _report(block[0], estimate[0])
    return first
