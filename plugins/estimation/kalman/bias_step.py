"""What a step of the inertial sensor's biases some time ago would have done to a state."""

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

from executive.arrays import Float
from executive.geometry import chi_square
from executive.geometry.rotation import skew

_UNLIKELY = 0.05  # probability of an innovation that is smaller than the one that was seen


def step_covariance(
    state: InertialState, since_s: float, gyro_rad_s: float, accel_m_s2: float
) -> Float:
    """Return the covariance that a step of both biases adds to a state, shape (15, 15).

    It is the integral of θ̇ = −b_g and v̇ = −R [f]× θ − R b_a at the present attitude and force.

    Args:
        state: The state.
        since_s: Time since the step [s].
        gyro_rad_s: Standard deviation of the gyroscope's step along an axis [rad/s].
        accel_m_s2: That of the accelerometer's [m/s²].
    """
    R, force = state.R_map_imu, state.sample.force - state.accel_bias
    by_gyro, by_accel = np.zeros((DIMENSION, 3)), np.zeros((DIMENSION, 3))
    pull = R @ skew(force)
    by_gyro[GYRO_BIAS] = by_accel[ACCEL_BIAS] = np.eye(3)
    by_gyro[ROTATION] = -since_s * np.eye(3)
    by_gyro[VELOCITY], by_gyro[POSITION] = pull * since_s**2 / 2, pull * since_s**3 / 6
    by_accel[VELOCITY], by_accel[POSITION] = -R * since_s, -R * since_s**2 / 2
    return np.asarray(gyro_rad_s**2 * by_gyro @ by_gyro.T + accel_m_s2**2 * by_accel @ by_accel.T)


def explaining_factor(residual: Float, S: Float, more: Float, largest: float) -> float:
    """Return the largest factor on a covariance with which an innovation is likely.

    The squared Mahalanobis distance is then exceeded by 95 % of such innovations: the step along
    the axes that the innovation does not show may be as much larger (covariance matching as of
    Mehra 1972, by the upper bound instead of the expectation).

    Args:
        residual: The innovation, shape (m,).
        S: Its covariance without the factor's part, shape (m, m).
        more: The part that is scaled, shape (m, m).
        largest: Largest factor.

    Returns:
        The factor; 0 if the innovation is usual without one.
    """
    L = np.linalg.cholesky(S)
    W = np.linalg.solve(L, np.linalg.solve(L, more).T)
    shares, axes = np.linalg.eigh(0.5 * (W + W.T))
    squares = (axes.T @ np.linalg.solve(L, residual)) ** 2
    if squares.sum() <= len(residual) or largest <= 0.0:
        return 0.0
    low, high, least = 0.0, largest, chi_square.quantile(_UNLIKELY, len(residual))
    for _ in range(60):
        middle = 0.5 * (low + high)
        distance2 = float((squares / (1.0 + middle * np.maximum(shares, 0.0))).sum())
        low, high = (middle, high) if distance2 > least else (low, middle)
    return high


def left(covariance: Float, gyro_rad_s: float, accel_m_s2: float) -> float:
    """Return the share of a step's variance by which the biases are known better than by it.

    A step that is larger than the body's usual motion is no error of a sensor, but of what a filter
    believes otherwise: a wrong heading, or fixes that were wrong.

    Args:
        covariance: Of the state's error, shape (15, 15).
        gyro_rad_s: Standard deviation of the gyroscope's step along an axis [rad/s].
        accel_m_s2: That of the accelerometer's [m/s²].
    """
    variances = np.diag(covariance)
    gyro = float(variances[GYRO_BIAS].mean()) / gyro_rad_s**2
    accel = float(variances[ACCEL_BIAS].mean()) / accel_m_s2**2
    return max(0.0, 1.0 - max(gyro, accel))


def grown(covariance: Float, factor: float, gyro_rad_s: float, accel_m_s2: float) -> Float:
    """Return by how much each standard deviation grows if all variances do by a factor, (15,).

    Those of the biases grow up to that of a step; see `left` for the arguments.
    """
    answer = np.full(DIMENSION, np.sqrt(factor))
    stds = np.sqrt(np.diag(covariance))
    for block, usual in ((GYRO_BIAS, gyro_rad_s), (ACCEL_BIAS, accel_m_s2)):
        answer[block] = np.clip(usual / stds[block], 1.0, answer[block])
    return answer
