"""What the sensors measure of a motion, in order of arrival: noise, bias walk, latency, and lidar
odometry that drifts.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from executive.arrays import Float
from executive.geometry.geodesy import geodetic_from_enu
from executive.machine.sensor import Gnss, Imu
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.odometry import LidarIncrement
from scenarios.faults import Fault
from scenarios.truth import RATE_HZ, Truth

DATUM = np.array([47.4084, 8.5106, 440.0])
GRAVITY = np.array([0.0, 0.0, 9.81])
LIDAR, LIDAR_HZ, LIDAR_LATENCY_S = "lidar_horizontal", 10, 0.05
_DT_S = 1 / RATE_HZ
Message = ImuSample | GnssFix | JointSample | LidarIncrement


@dataclass(frozen=True, slots=True)
class LidarErrors:
    """Errors of lidar odometry: those of matching to a submap, 0.3 % of the distance.

    Attributes:
        rotation_rad, translation_m: White noise of an increment, standard deviation.
        scale: Of the way, standard deviation over seeds.
        yaw_rad_m: Turn with the way, standard deviation over seeds [rad/m].
        declared: What it says of its standard deviations, over the white noise.
    """

    rotation_rad: float = 1e-4
    translation_m: float = 2e-3
    scale: float = 2e-3
    yaw_rad_m: float = 3e-5
    declared: float = 3.0


def stream(
    truth: Truth, end_s: float, fault: Fault, lidar: LidarErrors | None, rng: np.random.Generator
) -> list[tuple[float, Message]]:
    """Return arrival times [s] and messages, in order; inertial samples come at their stamp, which
    is k/100.
    """
    stamps = np.arange(1, round(end_s * RATE_HZ)) / RATE_HZ
    arrivals: list[tuple[float, int, Message]] = []
    for rank, name in enumerate(("imu_base", "imu_cabin")):
        arrivals += [(m.stamp_s, rank + 1, m) for m in _inertial(truth, name, stamps, rng)]
    arrivals += [(m.stamp_s, 0, m) for m in _joints(truth, stamps, rng)]
    for name in ("gnss_left", "gnss_right"):
        latency_s = truth.machine.sensors[name].latency_s
        arrivals += [(m.stamp_s + latency_s, 3, m) for m in _fixes(truth, name, end_s, fault, rng)]
    if lidar is not None:
        arrivals += [(m.to_s + LIDAR_LATENCY_S, 4, m) for m in increments(truth, end_s, lidar, rng)]
    arrivals.sort(key=lambda arrival: arrival[:2])
    return [(arrival_s, message) for arrival_s, _, message in arrivals]


def _inertial(
    truth: Truth, name: str, stamps: Float, rng: np.random.Generator
) -> Iterator[ImuSample]:
    """Yield means over the last sample: of the rate by the turn, of the force by the change of
    velocity.
    """
    sensor = truth.machine.sensors[name]
    if not isinstance(sensor, Imu):
        raise TypeError(f"{name} is no inertial sensor")
    edges = np.concatenate([stamps[:1] - _DT_S, stamps])
    R = Rotation.from_matrix(truth.T_map_sensor(name, edges)[:, :3, :3])
    rates = (R[:-1].inv() * R[1:]).as_rotvec() / _DT_S
    accelerations = np.diff(truth.velocity(name, edges), axis=0) / _DT_S
    middles = truth.T_map_sensor(name, stamps - _DT_S / 2)[:, :3, :3]
    forces = np.einsum("nji,nj->ni", middles, accelerations + GRAVITY)
    rates += _bias(sensor.gyro_bias_rad_s, sensor.gyro_walk_rad_s, len(stamps), rng)
    forces += _bias(sensor.accel_bias_m_s2, sensor.accel_walk_m_s2, len(stamps), rng)
    rates += rng.normal(0, sensor.gyro_noise_rad_s, rates.shape)
    forces += rng.normal(0, sensor.accel_noise_m_s2, forces.shape)
    for stamp_s, rate, force in zip(stamps.tolist(), rates, forces, strict=True):
        yield ImuSample(stamp_s, name, rate.copy(), force.copy())


def _bias(at_start: float, walk: float, n: int, rng: np.random.Generator) -> Float:
    return np.asarray(
        rng.normal(0, at_start, 3) + np.cumsum(rng.normal(0, walk * _DT_S**0.5, (n, 3)), axis=0)
    )


def _joints(truth: Truth, stamps: Float, rng: np.random.Generator) -> Iterator[JointSample]:
    names = truth.machine.joint_names
    angles, rates = truth.motion.turn(stamps)
    angles, rates = (
        angles + rng.normal(0, 2e-4, len(stamps)),
        rates + rng.normal(0, 2e-3, len(stamps)),
    )
    for stamp_s, angle, rate in zip(stamps.tolist(), angles, rates, strict=True):
        position, velocity = np.zeros(len(names)), np.zeros(len(names))
        position[0], velocity[0] = angle, rate
        yield JointSample(stamp_s, names, position, velocity, np.zeros(len(names)))


def _fixes(
    truth: Truth, name: str, end_s: float, fault: Fault, rng: np.random.Generator
) -> Iterator[GnssFix]:
    sensor = truth.machine.sensors[name]
    if not isinstance(sensor, Gnss):
        raise TypeError(f"{name} is no antenna")
    stamps = np.arange(1, round(end_s * sensor.rate_hz)) / sensor.rate_hz
    std = np.array([sensor.horizontal_noise_m, sensor.horizontal_noise_m, sensor.vertical_noise_m])
    positions = truth.T_map_sensor(name, stamps)[:, :3, 3] + rng.normal(0, std, (len(stamps), 3))
    for stamp_s, p_map in zip(stamps.tolist(), positions, strict=True):
        error = fault(stamp_s, name)
        if error is not None:
            yield GnssFix(
                stamp_s, name, geodetic_from_enu(p_map + error, DATUM), np.diag(std**2), True
            )


def increments(
    truth: Truth, end_s: float, errors: LidarErrors, rng: np.random.Generator
) -> Iterator[LidarIncrement]:
    """Yield the lidar's motions with white noise, an error of scale and a slow turn."""
    stamps = np.arange(1, round(end_s * LIDAR_HZ)) / LIDAR_HZ
    T = truth.T_map_sensor(LIDAR, stamps)
    moved = np.linalg.inv(T[:-1]) @ T[1:]
    scale, yaw_rad_m = rng.normal(0, errors.scale), rng.normal(0, errors.yaw_rad_m)
    way = np.linalg.norm(moved[:, :3, 3], axis=1)
    up_lidar = T[1:, 2, :3]  # the map's vertical in the lidar's axes
    turns = (
        rng.normal(0, errors.rotation_rad, (len(moved), 3)) + (yaw_rad_m * way)[:, None] * up_lidar
    )
    moved[:, :3, 3] *= 1 + scale
    moved[:, :3, 3] += rng.normal(0, errors.translation_m, (len(moved), 3))
    moved[:, :3, :3] = moved[:, :3, :3] @ Rotation.from_rotvec(turns).as_matrix()
    std = errors.declared * np.repeat([errors.rotation_rad, errors.translation_m], 3)
    for k, T_from_to in enumerate(moved):
        yield LidarIncrement(
            float(stamps[k]), float(stamps[k + 1]), LIDAR, T_from_to.copy(), np.diag(std**2)
        )
