"""Residuals and Jacobians of the filter's measurements (Solà 2017, error on the right)."""

import numpy as np
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    GYRO_BIAS,
    IDENTITY_3,
    POSITION,
    ROTATION,
    VELOCITY,
    InertialState,
)

from executive.arrays import Float
from executive.geometry.rotation import skew

# Each residual is measured − predicted, shape (3,), with H, the derivative of the prediction by the
# error of the state, shape (3, 15).


def antenna_residual(
    state: InertialState, arm_imu: Float, p_map_antenna: Float
) -> tuple[Float, Float]:
    """Compare a position fix with the predicted antenna, p_imu + R l: ∂/∂θ = −R [l]×.

    Here l is the antenna's lever arm in IMU axes [m].
    """
    H = np.zeros((3, DIMENSION))
    H[:, ROTATION] = -state.R_map_imu @ skew(arm_imu)
    H[:, POSITION] = IDENTITY_3
    return p_map_antenna - state.p_map_imu - state.R_map_imu @ arm_imu, H


def standstill_residual(state: InertialState, arm_imu: Float) -> tuple[Float, Float]:
    """Compare the velocity of a point on the turn axis, v_imu + R (ω × l), with zero.

    Here l is the point in IMU axes [m]. A point on the turn axis does not move while the chassis
    is at rest, even if the cabin turns.
    """
    speed = skew(state.rate) @ arm_imu
    H = np.zeros((3, DIMENSION))
    H[:, ROTATION] = -state.R_map_imu @ skew(speed)
    H[:, VELOCITY] = IDENTITY_3
    H[:, GYRO_BIAS] = state.R_map_imu @ skew(arm_imu)
    return -(state.v_map_imu + state.R_map_imu @ speed), H


def rate_residual(state: InertialState, rate_imu: Float) -> tuple[Float, Float]:
    """Compare the bias-free angular velocity with one measured otherwise [rad/s], IMU axes."""
    H = np.zeros((3, DIMENSION))
    H[:, GYRO_BIAS] = -IDENTITY_3
    return rate_imu - state.rate, H
