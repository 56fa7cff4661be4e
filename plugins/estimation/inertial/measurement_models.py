"""Residuals and Jacobians of the filter's measurements (Solà 2017, error on the right)."""

import numpy as np
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    InertialState,
)
from numba import njit, types

from executive.arrays import Float

_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
_MATRIX = types.Array(types.float64, 2, "A", readonly=True)
_NEW_VECTOR, _SLICE = types.float64[::1], types.Array(types.float64, 2, "A")

# Each residual is measured − predicted, shape (3,), with H, the derivative of the prediction by the
# error of the state, shape (3, 15).


def antenna_residual(
    state: InertialState, arm_imu: Float, p_map_antenna: Float
) -> tuple[Float, Float]:
    """Compare a position fix with the predicted antenna, p_imu + R l: ∂/∂θ = −R [l]×.

    Here l is the antenna's lever arm in IMU axes [m].
    """
    H, residual = np.empty((3, DIMENSION)), np.empty(3)
    write_antenna(state.R_map_imu, state.p_map_imu, arm_imu, p_map_antenna, residual, H)
    return residual, H


def standstill_residual(state: InertialState, arm_imu: Float) -> tuple[Float, Float]:
    """Compare the velocity of a point on the turn axis, v_imu + R (ω × l), with zero.

    Here l is the point in IMU axes [m]. A point on the turn axis does not move while the chassis
    is at rest, even if the cabin turns.
    """
    H, residual = np.empty((3, DIMENSION)), np.empty(3)
    write_standstill(state.R_map_imu, state.v_map_imu, state.rate, arm_imu, residual, H)
    return residual, H


@njit(cache=True)  # type: ignore[untyped-decorator]
def _turn_cross(R: Float, v: Float, sign: float, H: Float, first: int) -> None:
    """Write ±R [v]× from a column of H on.

    Slices of arrays would be shorter here, but bring code for shapes that differ and for overlaps:
    after a pause, a correction takes as long as it has code.
    """
    for i in range(3):
        for j in range(3):
            k, m = (j + 1) % 3, (j + 2) % 3
            H[i, first + j] = sign * (R[i, k] * v[m] - R[i, m] * v[k])


@njit(  # type: ignore[untyped-decorator]
    types.void(_MATRIX, _VECTOR, _VECTOR, _VECTOR, _NEW_VECTOR, _SLICE), cache=True
)
def write_antenna(
    R: Float, p: Float, arm: Float, antenna: Float, residual: Float, H: Float
) -> None:
    """Do what `antenna_residual` does, with results in arrays of the caller."""
    for i in range(3):
        for j in range(H.shape[1]):
            H[i, j] = 0.0
        H[i, 6 + i] = 1.0
        residual[i] = antenna[i] - p[i] - (R[i, 0] * arm[0] + R[i, 1] * arm[1] + R[i, 2] * arm[2])
    _turn_cross(R, arm, -1.0, H, 0)


@njit(  # type: ignore[untyped-decorator]
    types.void(_MATRIX, _VECTOR, _VECTOR, _VECTOR, _NEW_VECTOR, _SLICE), cache=True
)
def write_standstill(
    R: Float, v: Float, rate: Float, arm: Float, residual: Float, H: Float
) -> None:
    """Do what `standstill_residual` does, with results in arrays of the caller."""
    speed = np.empty(3)
    for i in range(3):
        k, m = (i + 1) % 3, (i + 2) % 3
        speed[i] = rate[k] * arm[m] - rate[m] * arm[k]
    for i in range(3):
        for j in range(H.shape[1]):
            H[i, j] = 0.0
        H[i, 3 + i] = 1.0
        residual[i] = -(v[i] + R[i, 0] * speed[0] + R[i, 1] * speed[1] + R[i, 2] * speed[2])
    _turn_cross(R, speed, -1.0, H, 0)
    _turn_cross(R, arm, 1.0, H, 9)
