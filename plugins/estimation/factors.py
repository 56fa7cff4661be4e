"""Conversion of measurements and states to GTSAM factors and back, with GTSAM's orders."""

from collections.abc import Sequence

import gtsam
import numpy as np
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.clock_offset import CLOCK_WALK_S, ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import LONG_GAP_S
from executive_plugins.estimation.inertial.state import (
    ACCEL_BIAS,
    DIMENSION,
    GYRO_BIAS,
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
)
from gtsam.symbol_shorthand import B, V, X, Z

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import skew

# 95 % efficient on Gaussian noise; redescending kernels (Tukey, Geman-McClure) diverged.
_HUBER = 1.345
_INTEGRATION_VARIANCE = 1e-10  # error of the position's integration within a sample [m²/s]
GAP_ACCELERATION_M_S2 = 1.0  # possible motion of the machine during a gap of inertial samples
GAP_RATE_RAD_S = 0.8
_LEAST_VARIANCE = 1e-12  # so that the covariance of an exactly known first state has an inverse
# GTSAM orders a node as pose (rotation, position in body axes), velocity, bias (accelerometer,
# gyro).
_ORDER = np.r_[ROTATION, POSITION, VELOCITY, ACCEL_BIAS, GYRO_BIAS]


def keys(node: int) -> tuple[int, int, int]:
    """Return the keys of a node's pose, velocity and bias."""
    return X(node), V(node), B(node)


def clock_key(node: int) -> int:
    """Return the key of the receiver's clock at a node: how late its stamps are [s].

    It comes after the node's other keys in GTSAM's order.
    """
    return int(Z(node))


def preintegration(noise: InertialNoise, gap_s: float = 0.0) -> gtsam.PreintegrationCombinedParams:
    """Return the parameters of preintegration (Forster 2017).

    Args:
        noise: Noise of the inertial sensor.
        gap_s: Length of a gap in the samples, which increases the covariance [s].
    """
    params = gtsam.PreintegrationCombinedParams.MakeSharedU(noise.gravity_m_s2)
    eye = np.eye(3)
    params.setAccelerometerCovariance(
        (noise.accel_density**2 + gap_s * GAP_ACCELERATION_M_S2**2) * eye
    )
    params.setGyroscopeCovariance((noise.gyro_density**2 + gap_s * GAP_RATE_RAD_S**2) * eye)
    params.setIntegrationCovariance(_INTEGRATION_VARIANCE * eye)
    params.setBiasAccCovariance(noise.accel_bias_walk**2 * eye)
    params.setBiasOmegaCovariance(noise.gyro_bias_walk**2 * eye)
    return params


def bias_of(state: InertialState) -> gtsam.imuBias.ConstantBias:
    """Return the biases of a state."""
    return gtsam.imuBias.ConstantBias(state.accel_bias, state.gyro_bias)


def insert(values: gtsam.Values, node: int, state: InertialState) -> None:
    """Insert a state as the values of a node."""
    x, v, b = keys(node)
    values.insert(x, gtsam.Pose3(pose(state.R_map_imu, state.p_map_imu)))
    values.insert(v, state.v_map_imu)
    values.insert(b, bias_of(state))


def extract(
    values: gtsam.Values, node: int, sample: Inertial, step: gtsam.VectorValues | None = None
) -> InertialState:
    """Return a node's values as a state at the end of a sample, after a step if there is one."""
    x, v, b = keys(node)
    T, velocity, bias = values.atPose3(x), values.atVector(v), values.atConstantBias(b).vector()
    if step is not None:
        T, velocity, bias = T.retract(step.at(x)), velocity + step.at(v), bias + step.at(b)
    return InertialState(
        sample,
        T.rotation().matrix(),
        np.array(T.translation()),
        np.array(velocity),
        bias[3:].copy(),
        bias[:3].copy(),
    )


def covariance_of(R_node: Float, R_map_imu: Float) -> Float:
    """Return the covariance of the error in our order and axes, shape (15 + k, 15 + k).

    Args:
        R_node: Square-root information of the newest node, in GTSAM's order, and of k constants
            after it, shape (15 + k, 15 + k).
        R_map_imu: Attitude of that node, shape (3, 3).
    """
    n = len(R_node)
    root = np.linalg.solve(R_node, np.eye(n))
    J = np.eye(n)
    J[:DIMENSION, :DIMENSION] = 0.0
    J[_ORDER, np.arange(DIMENSION)] = 1.0
    J[POSITION] = R_map_imu @ J[POSITION]
    root = J @ root
    return np.asarray(root @ root.T)


def prior(
    node: int, state: InertialState, covariance: Float, clock: ClockOffset | None = None
) -> list[gtsam.NonlinearFactor]:
    """Return one factor on a whole node with a full covariance, linear about the state.

    Args:
        node: The node.
        state: Its state.
        covariance: Of the state's error, shape (15, 15).
        clock: The receiver's clock; None if the node has none.
    """
    J = np.eye(DIMENSION)[_ORDER]
    J[3:6] = J[3:6] @ _rotated(state.R_map_imu)
    P = J @ covariance @ J.T
    values = gtsam.Values()
    insert(values, node, state)
    if clock is not None:
        cross = (J @ clock.cross)[:, None]
        P = np.block([[P, cross], [cross.T, clock.std_s**2]])
        values.insert(clock_key(node), np.array([clock.offset_s]))
    n = len(P)
    root = np.linalg.cholesky(np.linalg.inv(P + _LEAST_VARIANCE * np.eye(n))).T
    x, v, b = keys(node)
    blocks = [(x, root[:, :6]), (v, root[:, 6:9]), (b, root[:, 9:DIMENSION])]
    if clock is not None:
        blocks.append((clock_key(node), root[:, DIMENSION:]))
    linear = gtsam.GaussianConditional(
        blocks, len(blocks), np.zeros(n), gtsam.noiseModel.Unit.Create(n)
    )
    return [gtsam.LinearContainerFactor(linear, values)]


def _rotated(R_map_imu: Float) -> Float:
    """Return the matrix that takes our error to one with the position in IMU axes, (15, 15)."""
    J = np.eye(DIMENSION)
    J[POSITION, POSITION] = R_map_imu.T
    return J


def inertial_factor(
    nodes: tuple[int, int], first: InertialState, samples: Sequence[Inertial], noise: InertialNoise
) -> gtsam.NonlinearFactor:
    """Preintegrate the samples between two nodes.

    Forces act in the attitude at the middle of a sample, as in `propagate`.

    Args:
        nodes: The earlier node and the later one.
        first: The state at the earlier node, for its time and its biases.
        samples: The samples after it, the last one ending at the later node; at least one.
        noise: Noise of the inertial sensor.
    """
    gap_s = max(sample.since_last_s for sample in samples)
    sums = gtsam.PreintegratedCombinedMeasurements(
        preintegration(noise, gap_s if gap_s > LONG_GAP_S else 0.0), bias_of(first)
    )
    steps_s = np.diff([first.stamp_s, *(sample.stamp_s for sample in samples)])
    rates = np.array([sample.rate for sample in samples])
    forces = np.array([sample.force for sample in samples])
    turning = np.cross(rates - first.gyro_bias, forces - first.accel_bias)
    half_turned = forces + 0.5 * steps_s[:, None] * turning
    for force, rate, step_s in zip(half_turned, rates, steps_s.tolist(), strict=True):
        sums.integrateMeasurement(force, rate, step_s)
    (x0, v0, b0), (x1, v1, b1) = keys(nodes[0]), keys(nodes[1])
    return gtsam.CombinedImuFactor(x0, v0, x1, v1, b0, b1, sums)


def fix_factor(node: int, fix: Fix) -> gtsam.NonlinearFactor:
    """Return a factor on |p + R l − z|, which includes the lever arm l.

    The paper moves the antenna to the IMU beforehand (Nubert 2022, Eq. (8)–(9)). There, an error of
    heading causes an error of position; here it corrects the heading.
    """
    gaussian = gtsam.noiseModel.Gaussian.Covariance(fix.covariance)
    robust = gtsam.noiseModel.Robust.Create(
        gtsam.noiseModel.mEstimator.Huber.Create(_HUBER), gaussian
    )
    return gtsam.GPSFactorArm(X(node), fix.p_map_antenna, fix.arm_imu, robust)


def late_fix_factor(node: int, clock: int, fix: Fix, speed_map: Float) -> gtsam.NonlinearFactor:
    """Return a factor on a fix whose stamp is late by an unknown time d: |p + R l − s d − z|.

    A motion over d that is not linear is neglected: stamps are corrected by the offset that is
    known.

    Args:
        node: The node at the stamp.
        clock: Key of a vector of one element, d plus `fix.late_s` [s].
        fix: The fix.
        speed_map: Velocity s of the antenna in the map, as it is known beforehand [m/s], shape
            (3,). If it were the node's own, the node would fit the noise of the fix, the better the
            larger d is.
    """
    arm, z = fix.arm_imu, fix.p_map_antenna

    def error(this: gtsam.CustomFactor, values: gtsam.Values, H: list[Float] | None) -> Float:
        x, d = this.keys()
        T, late_s = values.atPose3(x), float(values.atVector(d)[0]) - fix.late_s
        R = T.rotation().matrix()
        if H is not None:
            H[0] = np.hstack([-R @ skew(arm), R])
            H[1] = -speed_map[:, None]
        return np.asarray(T.translation() + R @ arm - late_s * speed_map - z)

    gaussian = gtsam.noiseModel.Gaussian.Covariance(fix.covariance)
    robust = gtsam.noiseModel.Robust.Create(
        gtsam.noiseModel.mEstimator.Huber.Create(_HUBER), gaussian
    )
    return gtsam.CustomFactor(robust, [X(node), clock], error)


def clock_factor(nodes: tuple[int, int], over_s: float) -> gtsam.NonlinearFactor:
    """Return a factor on the receiver's clock at two nodes, which hardly changes from one to the
    other.

    Args:
        nodes: The earlier node and the later one.
        over_s: Time between them [s].
    """
    walk = gtsam.noiseModel.Isotropic.Sigma(1, CLOCK_WALK_S * np.sqrt(over_s))
    first, second = nodes
    return gtsam.BetweenFactorVector(clock_key(first), clock_key(second), np.zeros(1), walk)


def between_factor(
    first: int, second: int, T_first_second: Float, covariance: Float
) -> gtsam.NonlinearFactor:
    """Return a lidar increment as a relative pose (Nubert 2022, Sec. IV-A4a)."""
    gaussian = gtsam.noiseModel.Gaussian.Covariance(covariance)
    robust = gtsam.noiseModel.Robust.Create(
        gtsam.noiseModel.mEstimator.Huber.Create(_HUBER), gaussian
    )
    return gtsam.BetweenFactorPose3(X(first), X(second), gtsam.Pose3(T_first_second), robust)


def pose_factor(node: int, T_map_imu: Float, covariance: Float) -> gtsam.NonlinearFactor:
    """Return a pseudo-global lidar pose (Nubert 2022, Sec. IV-A4b).

    The covariance is that of (rotation, translation) in IMU axes, shape (6, 6).
    """
    gaussian = gtsam.noiseModel.Gaussian.Covariance(covariance)
    robust = gtsam.noiseModel.Robust.Create(
        gtsam.noiseModel.mEstimator.Huber.Create(_HUBER), gaussian
    )
    return gtsam.PriorFactorPose3(X(node), gtsam.Pose3(T_map_imu), robust)


def velocity_factor(node: int, v_map_imu: Float, std_m_s: float) -> gtsam.NonlinearFactor:
    """Return a factor on a velocity that was measured otherwise [m/s]."""
    return gtsam.PriorFactorVector(V(node), v_map_imu, gtsam.noiseModel.Isotropic.Sigma(3, std_m_s))


def gyro_bias_factor(node: int, gyro_bias: Float, std_rad_s: float) -> gtsam.NonlinearFactor:
    """Return a factor on a gyro bias that was measured otherwise [rad/s].

    The accelerometer's bias is constrained by 10 m/s² only, that is, practically not.
    """
    sigmas = np.concatenate([np.full(3, 10.0), np.full(3, std_rad_s)])
    bias = gtsam.imuBias.ConstantBias(np.zeros(3), gyro_bias)
    return gtsam.PriorFactorConstantBias(B(node), bias, gtsam.noiseModel.Diagonal.Sigmas(sigmas))
