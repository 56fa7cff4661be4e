"""A rig made from a log's static transforms, for bodies without a description."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.errors import DataError, did_you_mean
from executive.geometry.pose import pose
from executive.logs.decode import transform_of
from executive.machine.rig import Rig

# What a MEMS sensor does on a body that shakes: 5 to 50 times its data sheet's noise. Measured on a
# car: at rest the engine alone gives a spread of 0.13 m/s² and 0.05 rad/s, the road gives more, and
# the accelerometer's bias was 0.14 m/s². Half or twice these figures change the median error after
# an outage of 5 s or 10 s by up to a quarter.
_IMU = {
    "rate_hz": 100.0,
    "gyro_noise_rad_s": 0.03,
    "gyro_bias_rad_s": 0.1,
    "gyro_walk_rad_s": 3e-5,
    "accel_noise_m_s2": 0.4,
    "accel_bias_m_s2": 0.15,
    "accel_walk_m_s2": 1e-3,
}
_GNSS = {"rate_hz": 5.0, "horizontal_noise_m": 0.01, "vertical_noise_m": 0.02}
_LIDAR = {
    "rate_hz": 10.0,
    "lasers": 16,
    "elevation_rad": (-0.26, 0.26),
    "azimuth_step_rad": 0.0035,
    "range_m": (0.4, 100.0),
    "range_noise_m": 0.02,
}
_KINDS: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "imu": ("imu", _IMU),
    "gnss": ("gnss", _GNSS),
    "points": ("lidar", _LIDAR),
    "odometry": ("lidar", _LIDAR),
}


def rig_from(transforms: Iterable[Any], frames: Mapping[str, str], log: str) -> Rig:
    """Return one rigid body that carries sensors.

    Args:
        transforms: geometry_msgs/TransformStamped; the root of their tree is the body.
        frames: Kind of sensor by the name of its frame: imu, gnss, points or odometry.
        log: Name of the log, for errors.

    Raises:
        DataError: If there is no IMU, or if a sensor's frame is not in the tree, or not connected
            to the IMU's.
    """
    parents = {t.child_frame_id: (t.header.frame_id, transform_of(t.transform)) for t in transforms}
    known = {*parents, *(parent for parent, _ in parents.values())}
    poses: dict[str, tuple[str, Float]] = {}
    for frame in frames:
        if frame not in known:
            raise DataError(f"{log}: tf_static has no frame '{frame}'{did_you_mean(frame, known)}")
        poses[frame] = _to_root(frame, parents, log)
    bodies = [root for frame, (root, _) in poses.items() if frames[frame] == "imu"]
    if not bodies:
        raise DataError(
            f"{log}: no topic has IMU messages (sensor_msgs/Imu), so that it is not known which "
            "body carries the sensors; name the machine with --machine, or record the IMU's topic"
        )
    body = bodies[0]
    strangers = sorted(frame for frame, (root, _) in poses.items() if root != body)
    if strangers:
        raise DataError(
            f"{log}: tf_static does not connect {', '.join(strangers)} to '{body}', which "
            "carries the IMU; record the missing transform"
        )
    sensors = {frame: _sensor(frame, frames[frame], T) for frame, (_, T) in poses.items()}
    return Rig.model_validate({"name": body, "sensors": sensors})


def rig_of_levers(levers: Mapping[str, Float], frames: Mapping[str, str], log: str) -> Rig:
    """Return one rigid body whose axes are those of its inertial sensor.

    Args:
        levers: Place of each other sensor by its frame [m], shape (3,).
        frames: As in `rig_from`.
        log: Name of the log, for errors.

    Raises:
        DataError: If the log has not one inertial sensor, a sensor has no place, or a place is
            that of a frame that the log does not have.
    """
    imus = [frame for frame, kind in frames.items() if kind == "imu"]
    if len(imus) != 1:
        told = ", ".join(imus) or "none"
        raise DataError(f"{log}: places from the inertial sensor need one; the log has {told}")
    for frame in levers:
        if frame not in frames or frame in imus:
            hint = did_you_mean(frame, [one for one in frames if one not in imus])
            raise DataError(f"{log}: --lever: the log has no sensor of the frame '{frame}'{hint}")
    if missing := [frame for frame in frames if frame not in levers and frame not in imus]:
        raise DataError(f"{log}: --lever: the place of '{missing[0]}' is missing")
    poses = {imus[0]: np.eye(4)} | {frame: pose(t=at) for frame, at in levers.items()}
    sensors = {frame: _sensor(frame, frames[frame], T) for frame, T in poses.items()}
    return Rig.model_validate({"name": imus[0], "sensors": sensors})


def _to_root(frame: str, parents: Mapping[str, tuple[str, Float]], log: str) -> tuple[str, Float]:
    T, seen = np.eye(4), {frame}
    while frame in parents:
        frame, T_parent_frame = parents[frame]
        if frame in seen:
            raise DataError(f"{log}: the transforms of tf_static form a cycle at '{frame}'")
        seen.add(frame)
        T = T_parent_frame @ T
    return frame, T


def _sensor(name: str, kind: str, T_base_sensor: Float) -> dict[str, Any]:
    kind, figures = _KINDS[kind]
    R = T_base_sensor[:3, :3]
    rpy = (
        np.arctan2(R[2, 1], R[2, 2]),
        -np.arcsin(np.clip(R[2, 0], -1, 1)),
        np.arctan2(R[1, 0], R[0, 0]),
    )
    return {
        "kind": kind,
        "name": name,
        "link": "base",
        "xyz_m": tuple(map(float, T_base_sensor[:3, 3])),
        "rpy_rad": tuple(map(float, rpy)),
        "provenance": "guess",
        **figures,
    }
