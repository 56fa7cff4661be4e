"""Measurements of a motion by drawn sensors."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from drawn_logs.motion import GRAVITY_M_S2, Motion
from drawn_logs.sheets import GnssSheet, ImuSheet, OdometrySheet
from executive.arrays import Float
from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import exp_so3
from executive.logs.log import Arrival
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement

IMU, LIDAR = "imu", "lidar"


def inertial(motion: Motion, sheet: ImuSheet, rng: np.random.Generator) -> Iterator[Arrival]:
    """Yield the mean rate and specific force between two samples of the motion, with errors."""
    dt_s = 1.0 / sheet.rate_hz
    R, n = motion.R_map_body, len(motion.stamps_s) - 1
    turns = Rotation.from_matrix(np.einsum("nji,njk->nik", R[:-1], R[1:])).as_rotvec()
    middle = R[:-1] @ Rotation.from_rotvec(turns / 2).as_matrix()
    pull = np.diff(motion.v_map, axis=0) / dt_s + [0.0, 0.0, GRAVITY_M_S2]
    forces = np.einsum("nji,nj->ni", middle, pull)
    walk = np.sqrt(dt_s)
    gyro_bias = sheet.gyro_bias + np.cumsum(rng.normal(0, sheet.gyro_walk * walk, (n, 3)), axis=0)
    accel_bias = sheet.accel_bias + np.cumsum(
        rng.normal(0, sheet.accel_walk * walk, (n, 3)), axis=0
    )
    rates = turns / dt_s + gyro_bias + rng.normal(0, sheet.gyro_std, (n, 3))
    forces = forces + accel_bias + rng.normal(0, sheet.accel_std, (n, 3))
    for stamp_s, rate, force in zip(motion.stamps_s[1:], rates, forces, strict=True):
        yield Arrival(float(stamp_s), ImuSample(float(stamp_s), IMU, rate, force))


def satellite(
    motion: Motion, sheet: GnssSheet, datum: Float, rng: np.random.Generator
) -> Iterator[Arrival]:
    """Yield the fixes of all antennas, each with noise of the declared size times `truth`."""
    std_m = np.array([sheet.horizontal_m, sheet.horizontal_m, sheet.vertical_m])
    covariance = np.diag(std_m**2)
    last_s = motion.stamps_s[-1] - 0.3
    stamps = np.arange(0.1 + rng.uniform(0, 1 / sheet.rate_hz), last_s, 1 / sheet.rate_hz)
    for stamp_s in stamps:
        T = true_pose(motion, float(stamp_s))
        for number, antenna in enumerate(sheet.antennas):
            p_map = T[:3, :3] @ antenna + T[:3, 3] + sheet.truth * rng.normal(0, std_m)
            fix = GnssFix(
                float(stamp_s) + sheet.offset_s,
                antenna_name(number),
                geodetic_from_enu(p_map, datum),
                covariance,
                sheet.is_rtk_fixed,
            )
            yield Arrival(float(stamp_s) + sheet.latency_s, fix)


def odometric(motion: Motion, sheet: OdometrySheet, rng: np.random.Generator) -> Iterator[Arrival]:
    """Yield increments whose length is wrong by a share, and which turn with the distance."""
    stamps = np.arange(0.05, motion.stamps_s[-1], 1 / sheet.rate_hz)
    poses = [true_pose(motion, float(stamp_s)) for stamp_s in stamps]
    std = np.repeat([sheet.step_rad, sheet.step_m], 3)
    covariance = np.diag(std**2)
    for i in range(1, len(stamps)):
        T = inverse(poses[i - 1]) @ poses[i]
        length_m = float(np.linalg.norm(T[:3, 3]))
        noise = rng.normal(0, std)
        turn = noise[:3] + [0.0, 0.0, sheet.turn_rad_m * length_m]
        wrong = pose(T[:3, :3] @ exp_so3(turn), (1 + sheet.drift) * T[:3, 3] + noise[3:])
        to_s = float(stamps[i])
        yield Arrival(
            to_s + 0.05, LidarIncrement(float(stamps[i - 1]), to_s, LIDAR, wrong, covariance)
        )


def antenna_name(number: int) -> str:
    """Return the frame of an antenna."""
    return f"antenna_{number}"


def true_pose(motion: Motion, stamp_s: float) -> Float:
    """Return T_map_body at a time, shape (4, 4)."""
    times = motion.stamps_s
    i = int(np.clip(np.searchsorted(times, stamp_s) - 1, 0, len(times) - 2))
    f = float(np.clip((stamp_s - times[i]) / (times[i + 1] - times[i]), 0.0, 1.0))
    R = Slerp([0, 1], Rotation.from_matrix(motion.R_map_body[i : i + 2]))(f).as_matrix()
    return pose(R, (1 - f) * motion.p_map[i] + f * motion.p_map[i + 1])
