"""The strapdown state of one inertial sensor, and its propagation by samples."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.strapdown import (
    advance,
    carry_covariance_by,
    step_into,
    write_turn,
)

from executive.arrays import Float
from executive.geometry.rotation import skew

# Blocks of the error state: rotation [rad] in IMU axes, velocity and position in map axes, biases
# of gyroscope and accelerometer in IMU axes.
ROTATION, VELOCITY, POSITION, GYRO_BIAS, ACCEL_BIAS = (slice(i, i + 3) for i in range(0, 15, 3))
DIMENSION = 15
IDENTITY_3, _IDENTITY = np.eye(3), np.eye(DIMENSION)


@dataclass(frozen=True, slots=True, eq=False)
class Inertial:
    """One inertial measurement as the filter keeps it: bias not removed, IMU axes.

    It is the mean over the time since the previous sample, since sensors sample behind an
    anti-aliasing filter. If it were taken as the value at its stamp, a turn of 0.8 rad/s would lag
    by half a sample, 4 mrad.

    Attributes:
        stamp_s: End of the interval that it covers [s].
        rate: Angular velocity [rad/s], shape (3,).
        force: Specific force [m/s²], shape (3,).
        since_last_s: Time since the sample before [s]; long after a gap.
    """

    stamp_s: float
    rate: Float
    force: Float
    since_last_s: float = 0.0

    def until(self, stamp_s: float) -> "Inertial":
        """Return this measurement, cut off at an earlier time [s]."""
        return Inertial(stamp_s, self.rate, self.force, self.since_last_s)


@dataclass(frozen=True, slots=True, eq=False)
class InertialState:
    """Pose, velocity and sensor biases of an IMU at the end of its newest sample.

    Attributes:
        sample: The newest sample that was integrated.
        R_map_imu: Orientation, shape (3, 3).
        p_map_imu: Position in the map [m], shape (3,).
        v_map_imu: Velocity relative to the map, map axes [m/s], shape (3,).
        gyro_bias: [rad/s], IMU axes, shape (3,).
        accel_bias: [m/s²], IMU axes, shape (3,).
    """

    sample: Inertial
    R_map_imu: Float
    p_map_imu: Float
    v_map_imu: Float
    gyro_bias: Float
    accel_bias: Float

    @property
    def stamp_s(self) -> float:
        """Time of validity [s]."""
        return self.sample.stamp_s

    @property
    def rate(self) -> Float:
        """Angular velocity in IMU axes, bias removed [rad/s], shape (3,)."""
        return self.sample.rate - self.gyro_bias


def propagate(state: InertialState, sample: Inertial, gravity_m_s2: float) -> InertialState:
    """Propagate the state to the end of a later sample.

    The force acts in the attitude at the middle of the sample. The rotation of the earth is
    neglected.
    """
    return propagate_through(state, (sample,), gravity_m_s2)


def propagate_through(
    state: InertialState, samples: Iterable[Inertial], gravity_m_s2: float
) -> InertialState:
    """Propagate the state through several samples, oldest first.

    It is faster than repeated calls of `propagate`, for only the last state is constructed.
    """
    last, R, p, v = state.sample, state.R_map_imu, state.p_map_imu, state.v_map_imu
    gyro_bias, accel_bias = state.gyro_bias, state.accel_bias
    for sample in samples:
        dt_s = sample.stamp_s - last.stamp_s
        found = np.empty((3, 3)), np.empty(3), np.empty(3)
        advance(
            R, p, v, gyro_bias, accel_bias, sample.rate, sample.force, dt_s, gravity_m_s2, *found
        )
        R, p, v = found
        last = sample
    return InertialState(last, R, p, v, gyro_bias, accel_bias)


def carry_covariance(
    state: InertialState, covariance: Float, noise: InertialNoise, dt_s: float
) -> Float:
    """Propagate the covariance of the state's error over a step, shape (15, 15)."""
    force = state.sample.force - state.accel_bias
    after = np.empty((DIMENSION, DIMENSION))
    carry_covariance_by(
        covariance, state.R_map_imu, state.rate, force, noise.densities, dt_s, after
    )
    return after


def stepped(
    state: InertialState, covariance: Float, cross: Float, sample: Inertial, noise: InertialNoise
) -> tuple[InertialState, Float, Float]:
    """Propagate a state and the uncertainty of its error to the end of a later sample.

    Args:
        state: The state before the step.
        covariance: Of its error, shape (15, 15).
        cross: Cross-covariance of its error with k others, shape (15, k).
        sample: The sample that the step leads to.
        noise: Noise of the inertial sensor.

    Returns:
        The three after the step.
    """
    newest, dt_s = state.sample, sample.stamp_s - state.sample.stamp_s
    P, C = np.empty((DIMENSION, DIMENSION)), np.empty(cross.shape)
    R, p, v = np.empty((3, 3)), np.empty(3), np.empty(3)
    step_into(
        covariance,
        cross,
        state.R_map_imu,
        state.p_map_imu,
        state.v_map_imu,
        state.gyro_bias,
        state.accel_bias,
        newest.rate,
        newest.force,
        sample.rate,
        sample.force,
        noise.densities,
        dt_s,
        noise.gravity_m_s2,
        P,
        C,
        R,
        p,
        v,
    )
    return InertialState(sample, R, p, v, state.gyro_bias, state.accel_bias), P, C


def error_transition(state: InertialState, dt_s: float) -> Float:
    """Return ∂(error after)/∂(error before) over a step, to first order, shape (15, 15).

    The rotation's error is on the right, R = R̂ exp(θ), so that θ̇ = −ω×θ − b_g and
    v̇ = −R [f]× θ − R b_a.
    """
    R, force = state.R_map_imu, state.sample.force - state.accel_bias
    F = _IDENTITY.copy()
    F[ROTATION, ROTATION] = rotation_step(-dt_s * state.rate)
    F[ROTATION, GYRO_BIAS] = -dt_s * IDENTITY_3
    F[VELOCITY, ROTATION] = -dt_s * (R @ skew(force))
    F[VELOCITY, ACCEL_BIAS] = -dt_s * R
    F[POSITION, VELOCITY] = dt_s * IDENTITY_3
    F[POSITION, ROTATION] = 0.5 * dt_s * F[VELOCITY, ROTATION]
    F[POSITION, ACCEL_BIAS] = 0.5 * dt_s * F[VELOCITY, ACCEL_BIAS]
    return F


def retract(state: InertialState, error: Float) -> InertialState:
    """Apply an error-state correction, shape (15,)."""
    return InertialState(
        state.sample,
        state.R_map_imu @ rotation_step(error[ROTATION]),
        state.p_map_imu + error[POSITION],
        state.v_map_imu + error[VELOCITY],
        state.gyro_bias + error[GYRO_BIAS],
        state.accel_bias + error[ACCEL_BIAS],
    )


def rotation_step(rotation_vector: Float) -> Float:
    """Map a rotation vector [rad] to its matrix (Rodrigues), shape (3,) → (3, 3)."""
    R = np.empty((3, 3))
    write_turn(*rotation_vector.tolist(), R)
    return R
