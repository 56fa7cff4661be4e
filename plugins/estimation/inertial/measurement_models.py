"""What the filter's measurements should read, and how the state's error changes it (Solà 2017,
error on the right).
"""

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

# Each returns measured − predicted, shape (3,), and its derivative by the state's error, negated,
# shape (3, 15).


def antenna_residual(
    state: InertialState, arm_imu: Float, p_map_antenna: Float
) -> tuple[Float, Float]:
    """Compare a fix with p_imu + R l, where l is the antenna's lever arm in IMU axes [m]: ∂/∂θ = −R
    [l]×.
    """
    H = np.zeros((3, DIMENSION))
    H[:, ROTATION] = -state.R_map_imu @ skew(arm_imu)
    H[:, POSITION] = IDENTITY_3
    return p_map_antenna - state.p_map_imu - state.R_map_imu @ arm_imu, H


def standstill_residual(state: InertialState, arm_imu: Float) -> tuple[Float, Float]:
    """Compare the speed of a point of the cabin that is on the turn axis, v_imu + R (ω × l), with
    zero.
    """
    speed = skew(state.rate) @ arm_imu
    H = np.zeros((3, DIMENSION))
    H[:, ROTATION] = -state.R_map_imu @ skew(speed)
    H[:, VELOCITY] = IDENTITY_3
    H[:, GYRO_BIAS] = state.R_map_imu @ skew(arm_imu)
    return -(state.v_map_imu + state.R_map_imu @ speed), H


def rate_residual(state: InertialState, rate_imu: Float) -> tuple[Float, Float]:
    """Compare the angular velocity, bias removed, with one that is known otherwise [rad/s], both in
    IMU axes.
    """
    H = np.zeros((3, DIMENSION))
    H[:, GYRO_BIAS] = -IDENTITY_3
    return rate_imu - state.rate, H
