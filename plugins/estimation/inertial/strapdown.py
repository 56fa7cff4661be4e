"""The strapdown equations in compiled form, for the work at each inertial sample.

NumPy calls on arrays of this size cost more than their arithmetic. Signatures are fixed, so that
everything is compiled when this file is imported (once; afterwards it is read from a cache) and no
sample waits for a compiler. Read-only arrays of any layout are accepted, since messages hold such
arrays. Results are written into arrays of the caller: returning an array costs a microsecond.
"""

import math

import numpy as np
from numba import njit, types

from executive.arrays import Float

_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
_MATRIX = types.Array(types.float64, 2, "A", readonly=True)
_NEW_VECTOR, _NEW_MATRIX = types.float64[::1], types.float64[:, ::1]
_REAL = types.float64
_N = 15  # errors of rotation, velocity, position, gyro bias, accelerometer bias, as in `state`


@njit(cache=True)  # type: ignore[untyped-decorator]
def turn_into(x: float, y: float, z: float, R: Float) -> None:
    """Write the matrix of a rotation vector [rad] (Rodrigues), shape (3, 3)."""
    angle2 = x * x + y * y + z * z
    if angle2 < 1e-10:  # the next terms of both series are below 1e-11
        a, b = 1.0 - angle2 / 6, 0.5 - angle2 / 24
    else:
        angle = math.sqrt(angle2)
        a, b = math.sin(angle) / angle, (1 - math.cos(angle)) / angle2
    R[0, 0], R[0, 1], R[0, 2] = 1 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y
    R[1, 0], R[1, 1], R[1, 2] = b * x * y + a * z, 1 - b * (x * x + z * z), b * y * z - a * x
    R[2, 0], R[2, 1], R[2, 2] = b * x * z - a * y, b * y * z + a * x, 1 - b * (x * x + y * y)


@njit(types.void(_REAL, _REAL, _REAL, _NEW_MATRIX), cache=True)  # type: ignore[untyped-decorator]
def write_turn(x: float, y: float, z: float, R: Float) -> None:
    """Do what `turn_into` does, for callers that are not compiled."""
    turn_into(x, y, z, R)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _turn(v: Float, factor: float) -> Float:
    """Map a rotation vector [rad] times a factor to its matrix, shape (3,) → (3, 3)."""
    R = np.empty((3, 3))
    turn_into(factor * v[0], factor * v[1], factor * v[2], R)
    return R


@njit(cache=True)  # type: ignore[untyped-decorator]
def multiply(A: Float, B: Float, C: Float) -> None:
    """Compute C = A B, shapes (3, 3)."""
    for i in range(3):
        for j in range(3):
            C[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]


@njit(cache=True)  # type: ignore[untyped-decorator]
def chain(A: Float, B: Float, C: Float) -> None:
    """Compute C = A B for poses, shapes (4, 4)."""
    for i in range(3):
        for j in range(4):
            C[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]
        C[i, 3] += A[i, 3]
        C[3, i] = 0.0
    C[3, 3] = 1.0


@njit(  # type: ignore[untyped-decorator]
    types.void(
        *(_MATRIX, _VECTOR, _VECTOR, _VECTOR, _VECTOR, _VECTOR, _VECTOR, _REAL, _REAL),
        *(_NEW_MATRIX, _NEW_VECTOR, _NEW_VECTOR),
    ),
    cache=True,
)
def advance(  # noqa: PLR0913 - compiled code takes the arrays of a state one by one
    R: Float,
    p: Float,
    v: Float,
    gyro_bias: Float,
    accel_bias: Float,
    rate: Float,
    force: Float,
    dt_s: float,
    gravity_m_s2: float,
    R_after: Float,
    p_after: Float,
    v_after: Float,
) -> None:
    """Compute orientation, position and velocity after a step.

    The force acts in the attitude at the middle of the step.

    Args:
        R, p, v: Before the step, in the map, shapes (3, 3), (3,) [m], (3,) [m/s].
        gyro_bias, accel_bias: [rad/s], [m/s²], IMU axes, shape (3,) each.
        rate, force: As measured [rad/s], [m/s²], IMU axes, shape (3,) each.
        dt_s: Length of the step [s].
        gravity_m_s2: Along the map's −z.
        R_after, p_after, v_after: Results, of the same shapes.
    """
    half_turn, R_middle, half_s, b = np.empty((3, 3)), np.empty((3, 3)), 0.5 * dt_s, gyro_bias
    turn_into(
        half_s * (rate[0] - b[0]), half_s * (rate[1] - b[1]), half_s * (rate[2] - b[2]), half_turn
    )
    multiply(R, half_turn, R_middle)
    multiply(R_middle, half_turn, R_after)
    x, y, z = force[0] - accel_bias[0], force[1] - accel_bias[1], force[2] - accel_bias[2]
    for i in range(3):
        acceleration = R_middle[i, 0] * x + R_middle[i, 1] * y + R_middle[i, 2] * z
        if i == 2:
            acceleration -= gravity_m_s2
        v_after[i] = v[i] + dt_s * acceleration
        p_after[i] = p[i] + 0.5 * dt_s * (v[i] + v_after[i])


@njit(cache=True)  # type: ignore[untyped-decorator]
def _carry_rows(
    P: Float, turned_back: Float, R: Float, by_rotation: Float, dt_s: float, after: Float
) -> None:
    """Compute F P, with F the error transition of `state.error_transition`."""
    for j in range(P.shape[1]):
        for i in range(3):
            t = (
                turned_back[i, 0] * P[0, j]
                + turned_back[i, 1] * P[1, j]
                + turned_back[i, 2] * P[2, j]
            )
            push = (
                by_rotation[i, 0] * P[0, j]
                + by_rotation[i, 1] * P[1, j]
                + by_rotation[i, 2] * P[2, j]
            )
            push += R[i, 0] * P[12, j] + R[i, 1] * P[13, j] + R[i, 2] * P[14, j]
            after[i, j] = t - dt_s * P[9 + i, j]
            after[3 + i, j] = P[3 + i, j] - dt_s * push
            after[6 + i, j] = P[6 + i, j] + dt_s * P[3 + i, j] - 0.5 * dt_s * dt_s * push
            after[9 + i, j] = P[9 + i, j]
            after[12 + i, j] = P[12 + i, j]


@njit(cache=True)  # type: ignore[untyped-decorator]
def turned_cross(R: Float, force: Float) -> Float:
    """Return R [f]×, shape (3, 3)."""
    product = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            k, m = (j + 1) % 3, (j + 2) % 3
            product[i, j] = R[i, k] * force[m] - R[i, m] * force[k]
    return product


@njit(cache=True)  # type: ignore[untyped-decorator]
def carry_covariance_into(
    P: Float, R: Float, rate: Float, force: Float, densities: Float, dt_s: float, after: Float
) -> None:
    """Compute F P Fᵀ + Q as `carry_covariance_by` does, for callers in compiled code."""
    turned_back, by_rotation = _turn(rate, -dt_s), turned_cross(R, force)
    half = np.empty((_N, _N))
    _carry_rows(P, turned_back, R, by_rotation, dt_s, half)
    # F (F P)ᵀ = F P Fᵀ, for P is symmetric.
    _carry_rows(half.T, turned_back, R, by_rotation, dt_s, after)
    for i in range(3):
        after[i, i] += densities[0] ** 2 * dt_s
        after[3 + i, 3 + i] += densities[1] ** 2 * dt_s
        after[6 + i, 6 + i] += densities[1] ** 2 * dt_s**3 / 3
        after[9 + i, 9 + i] += densities[2] ** 2 * dt_s
        after[12 + i, 12 + i] += densities[3] ** 2 * dt_s


@njit(  # type: ignore[untyped-decorator]
    types.void(_MATRIX, _MATRIX, _VECTOR, _VECTOR, _VECTOR, _REAL, _NEW_MATRIX), cache=True
)
def carry_covariance_by(
    P: Float, R: Float, rate: Float, force: Float, densities: Float, dt_s: float, after: Float
) -> None:
    """Compute F P Fᵀ + Q, the covariance of the state's error after a step, shape (15, 15).

    Args:
        P: Before, shape (15, 15).
        R: Orientation before, shape (3, 3).
        rate, force: Biases removed [rad/s], [m/s²], IMU axes, shape (3,) each.
        densities: White noise of gyro and accelerometer, then the walks of their biases,
            shape (4,).
        dt_s: Length of the step [s].
        after: Result, shape (15, 15).
    """
    carry_covariance_into(P, R, rate, force, densities, dt_s, after)


@njit(  # type: ignore[untyped-decorator]
    types.void(
        *(_MATRIX, _MATRIX, _MATRIX, _VECTOR, _VECTOR, _VECTOR, _VECTOR, _VECTOR, _VECTOR),
        *(_VECTOR, _VECTOR, _VECTOR, _REAL, _REAL),
        *(_NEW_MATRIX, _NEW_MATRIX, _NEW_MATRIX, _NEW_VECTOR, _NEW_VECTOR),
    ),
    cache=True,
)
def step_into(  # noqa: PLR0913 - compiled code takes the arrays of a state one by one
    P: Float,
    C: Float,
    R: Float,
    p: Float,
    v: Float,
    gyro_bias: Float,
    accel_bias: Float,
    rate: Float,
    force: Float,
    next_rate: Float,
    next_force: Float,
    densities: Float,
    dt_s: float,
    gravity_m_s2: float,
    P_after: Float,
    C_after: Float,
    R_after: Float,
    p_after: Float,
    v_after: Float,
) -> None:
    """Compute a state, its covariance and the cross-covariances of its error after a step.

    Three calls in one: between samples the caches cool, and each call would read its code anew.

    Args:
        P: Covariance of the state's error, shape (15, 15).
        C: Cross-covariance of that error with k others, shape (15, k).
        rate, force: Of the newest sample that was integrated; the covariance is carried by them.
        next_rate, next_force: Of the sample that the step leads to; the state is moved by them.
        densities: See `carry_covariance_by`.
        P_after, C_after: Results, of the shapes of P and C.

    The others are those of `advance`.
    """
    own_rate, own_force = np.empty(3), np.empty(3)
    for i in range(3):
        own_rate[i], own_force[i] = rate[i] - gyro_bias[i], force[i] - accel_bias[i]
    if C.shape[1] > 0:
        turned_back, by_rotation = _turn(own_rate, -dt_s), turned_cross(R, own_force)
        _carry_rows(C, turned_back, R, by_rotation, dt_s, C_after)
    carry_covariance_into(P, R, own_rate, own_force, densities, dt_s, P_after)
    advance(
        R,
        p,
        v,
        gyro_bias,
        accel_bias,
        next_rate,
        next_force,
        dt_s,
        gravity_m_s2,
        R_after,
        p_after,
        v_after,
    )
