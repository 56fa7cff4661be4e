"""Corrections of a strapdown state that turn velocity and position along with its attitude.

Source: the left-invariant error of Barrau and Bonnabel 2017 (The invariant extended Kalman filter
as a stable observer). A heading that is wrong by an angle puts the carrier of a well-measured
antenna on a circle, and what was integrated since a known velocity too. With the exponential of
the group of extended poses, an error is exactly of that form however large the angle is: velocity
and position differ from the state's by J(θ) w, with the left Jacobian J of rotations.
"""

import math

import numpy as np
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    POSITION,
    ROTATION,
    VELOCITY,
    InertialState,
)
from executive_plugins.estimation.inertial.strapdown import multiply, turn_into
from numba import njit, types

from executive.arrays import Float
from executive.geometry.rotation import skew

_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
_MATRIX = types.Array(types.float64, 2, "A", readonly=True)
_NEW_MATRIX = types.float64[:, ::1]
_TERMS = 30  # of the series of a turn by π: the next one is below 1e-17
_SMALL_RAD2 = 1e-10  # below, the next terms of the series are below 1e-11


def moved(state: InertialState, error: Float) -> tuple[InertialState, Float]:
    """Apply a correction; to first order it is `retract`.

    Args:
        state: The state.
        error: Its error, shape (15,).

    Returns:
        The state after it, and the derivative of what is left of the error by the error, shape
        (15, 15).
    """
    J, R, vectors = np.empty((DIMENSION, DIMENSION)), np.empty((3, 3)), np.empty((4, 3))
    move(
        state.R_map_imu,
        state.p_map_imu,
        state.v_map_imu,
        state.gyro_bias,
        state.accel_bias,
        error,
        J,
        R,
        vectors,
    )
    return InertialState(state.sample, R, *vectors), J


def moved_far(state: InertialState, error: Float) -> tuple[InertialState, Float]:
    """Do what `moved` does, with a derivative that holds for turns of up to π; it is slower."""
    R, answer = state.R_map_imu, np.eye(DIMENSION)
    after, _ = moved(state, error)
    across = skew(error[ROTATION])
    adjoint = np.zeros((9, 9))
    for block in (VELOCITY, POSITION):
        adjoint[block, block], adjoint[block, ROTATION] = across, skew(R.T @ error[block])
    adjoint[ROTATION, ROTATION] = across
    term = series = np.eye(9)
    for n in range(1, _TERMS):
        term = -term @ adjoint / (n + 1)
        series = series + term
    before, turned = np.eye(9), np.eye(9)
    for block in (VELOCITY, POSITION):
        before[block, block], turned[block, block] = R.T, after.R_map_imu
    answer[:9, :9] = turned @ series @ before
    return after, answer


def left_jacobian(theta: Float) -> Float:
    """Return J with J(θ) [θ]× = exp([θ]×) − 1 of a rotation vector [rad], shape (3, 3)."""
    answer, unused = np.empty((3, 3)), np.empty((3, 3))
    turn_along(np.eye(3), theta, np.zeros(3), answer, unused, np.empty((3, 3)))
    return answer


def linear_covariance(state: InertialState, covariance: Float) -> Float:
    """Return the covariance of errors as differences in map axes, shape (15, 15).

    A position whose error is J(θ) w differs from the state's by w + θ × w / 2 and smaller terms.
    The second moment of θ × w / 2 is added: it is what remains across a direction in which the
    linear terms cancel.
    """
    answer = np.empty((DIMENSION, DIMENSION))
    linearise(state.R_map_imu, covariance, answer)
    return answer


@njit(cache=True)  # type: ignore[untyped-decorator]
def _crossed(v: tuple[float, float, float], i: int, j: int) -> float:
    """Return an element of [v]×."""
    if i == j:
        return 0.0
    return v[3 - i - j] if (j - i) % 3 == 2 else -v[3 - i - j]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _product(A: Float, B: Float) -> Float:
    """Return A B, shapes (3, 3)."""
    answer = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                answer[i, j] += A[i, k] * B[k, j]
    return answer


@njit(cache=True)  # type: ignore[untyped-decorator]
def _turn_left(R: Float, theta: Float, by_self: Float, rotation: Float) -> None:
    """Write what `turn_along` does, less what depends on the vector."""
    t = theta[0], theta[1], theta[2]
    angle2 = t[0] ** 2 + t[1] ** 2 + t[2] ** 2
    b, c = 0.5 - angle2 / 24, 1 / 6 - angle2 / 120
    if angle2 > _SMALL_RAD2:
        angle = math.sqrt(angle2)
        b, c = (1 - math.cos(angle)) / angle2, (angle - math.sin(angle)) / (angle * angle2)
    J, half = np.empty((3, 3)), np.empty((3, 3))
    for i in range(3):
        k, m = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            across = _crossed(t, i, j)
            twice = t[i] * t[j] if i != j else -t[k] * t[k] - t[m] * t[m]
            unit = 1.0 if i == j else 0.0
            J[i, j] = unit + b * across + c * twice
            rotation[i, j] = unit - b * across + c * twice
    multiply(R, J, half)
    multiply(half, R.T, by_self)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _bend(R: Float, theta: Float, w: Float, by_rotation: Float) -> None:
    """Write the derivative of J(θ) w by θ, as `turn_along` does."""
    t = theta[0], theta[1], theta[2]
    x = R[0, 0] * w[0] + R[1, 0] * w[1] + R[2, 0] * w[2]
    y = R[0, 1] * w[0] + R[1, 1] * w[1] + R[2, 1] * w[2]
    z = R[0, 2] * w[0] + R[1, 2] * w[1] + R[2, 2] * w[2]
    body = x, y, z
    turned = t[1] * z - t[2] * y, t[2] * x - t[0] * z, t[0] * y - t[1] * x
    curved = np.empty((3, 3))
    for i in range(3):
        k, m = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            both = body[i] * t[j] if i != j else -t[k] * body[k] - t[m] * body[m]
            second = (both + _crossed(turned, i, j)) / 6 + turned[i] * t[j] / 12
            curved[i, j] = -0.5 * _crossed(body, i, j) - second
    multiply(R, curved, by_rotation)


_SLICE = types.Array(types.float64, 2, "A")


@njit(  # type: ignore[untyped-decorator]
    types.void(_MATRIX, _VECTOR, _VECTOR, _SLICE, _SLICE, _SLICE), cache=True
)
def turn_along(
    R: Float, theta: Float, w: Float, by_self: Float, by_rotation: Float, rotation: Float
) -> None:
    """Write the derivatives of the error that a correction leaves.

    Args:
        R: Attitude before the correction, shape (3, 3).
        theta: Its correction [rad], body axes, shape (3,).
        w: Correction of the velocity or the position, map axes, shape (3,).
        by_self: R J(θ) Rᵀ, by which the vector moves and the error that is left turns, (3, 3).
        by_rotation: Derivative of J(θ) w by θ, to second order, shape (3, 3).
        rotation: Derivative of the rotation that is left, J(−θ), shape (3, 3).
    """
    _turn_left(R, theta, by_self, rotation)
    _bend(R, theta, w, by_rotation)


@njit(  # type: ignore[untyped-decorator]
    types.void(
        *(_MATRIX, _VECTOR, _VECTOR, _VECTOR, _VECTOR, _VECTOR),
        *(_SLICE, _NEW_MATRIX, _NEW_MATRIX),
    ),
    cache=True,
)
def move(  # noqa: PLR0913 - compiled code takes the arrays of a state one by one
    R: Float,
    p: Float,
    v: Float,
    gyro_bias: Float,
    accel_bias: Float,
    error: Float,
    J: Float,
    R_after: Float,
    after: Float,
) -> None:
    """Do what `moved` does, with results in arrays of the caller.

    Args:
        J: Derivative of what is left of the error, shape (15, 15).
        R_after: Attitude after, shape (3, 3).
        after: Position, velocity and both biases after, shape (4, 3).
    """
    theta = error[0:3]
    for i in range(15):
        for j in range(15):
            J[i, j] = 1.0 if i == j else 0.0
    _turn_left(R, theta, J[3:6, 3:6], J[0:3, 0:3])
    for i in range(3):
        for j in range(3):
            J[6 + i, 6 + j] = J[3 + i, 3 + j]
    _bend(R, theta, error[3:6], J[3:6, 0:3])
    _bend(R, theta, error[6:9], J[6:9, 0:3])
    turn = np.empty((3, 3))
    turn_into(theta[0], theta[1], theta[2], turn)
    multiply(R, turn, R_after)
    for i in range(3):
        after[0, i], after[1, i] = p[i], v[i]
        for j in range(3):
            after[0, i] += J[6 + i, 6 + j] * error[6 + j]
            after[1, i] += J[3 + i, 3 + j] * error[3 + j]
        after[2, i], after[3, i] = gyro_bias[i] + error[9 + i], accel_bias[i] + error[12 + i]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _fourth(P: Float, W: Float, X: Float, i: int, j: int, k: int, m: int) -> float:
    """Return E θ_i w_j θ_k w_m of Gaussian errors (Isserlis 1918)."""
    return float(P[i, k] * W[j, m] + X[i, j] * X[k, m] + X[i, m] * X[k, j])


@njit(cache=True)  # type: ignore[untyped-decorator]
def _add_curvature(R: Float, P_body: Float, W: Float, X_body: Float, after: Float) -> None:
    """Add the second moment of θ × w / 2, map axes.

    Args:
        R: Attitude, shape (3, 3).
        P_body: Covariance of the rotation θ, body axes, shape (3, 3).
        W: Covariance of w, map axes, shape (3, 3).
        X_body: Covariance of θ, body axes, with w, shape (3, 3).
        after: What is added to, shape (3, 3).
    """
    P, X = _product(_product(R, P_body), R.T), _product(R, X_body)
    for i in range(3):
        a, b = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            c, d = (j + 1) % 3, (j + 2) % 3
            after[i, j] += 0.25 * (
                _fourth(P, W, X, a, b, c, d)
                - _fourth(P, W, X, a, b, d, c)
                - _fourth(P, W, X, b, a, c, d)
                + _fourth(P, W, X, b, a, d, c)
            )


@njit(types.void(_MATRIX, _MATRIX, _NEW_MATRIX), cache=True)  # type: ignore[untyped-decorator]
def linearise(R: Float, P: Float, after: Float) -> None:
    """Do what `linear_covariance` does, with the attitude R and the result in an array."""
    for i in range(P.shape[0]):
        for j in range(P.shape[1]):
            after[i, j] = P[i, j]
    for k in (3, 6):
        W, X = P[k : k + 3, k : k + 3], P[0:3, k : k + 3]
        _add_curvature(R, P[0:3, 0:3], W, X, after[k : k + 3, k : k + 3])
