"""Conversion of ROS messages to the messages of this project."""

from typing import Any

import numpy as np

from executive.arrays import Float
from executive.errors import DataError, ShapeError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_quaternion
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan

# sensor_msgs/NavSatStatus; RTK receivers report a fixed solution as ground-based augmentation.
_NO_FIX, _GROUND_AUGMENTED = -1, 2
# NumPy types of sensor_msgs/PointField
_NUMPY = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
_TIMES = {"time": 1.0, "t": 1e-9}  # names and units [s] of a point's time, as drivers write them


def stamp_ns(message: Any) -> int:
    """Return the header's stamp [ns]."""
    return int(message.header.stamp.sec) * 1_000_000_000 + int(message.header.stamp.nanosec)


def imu_sample(message: Any, stamp_s: float) -> ImuSample:
    """Return a sensor_msgs/Imu; its orientation is not used."""
    w, f = message.angular_velocity, message.linear_acceleration
    return ImuSample(
        stamp_s, message.header.frame_id, np.array([w.x, w.y, w.z]), np.array([f.x, f.y, f.z])
    )


def gnss_fix(message: Any, stamp_s: float) -> GnssFix | None:
    """Return a sensor_msgs/NavSatFix, or None where the receiver had no fix."""
    if message.status.status == _NO_FIX:
        return None
    return GnssFix(
        stamp_s,
        message.header.frame_id,
        np.array([message.latitude, message.longitude, message.altitude]),
        np.array(message.position_covariance, dtype=float).reshape(3, 3),
        message.status.status >= _GROUND_AUGMENTED,
    )


def joint_sample(message: Any, stamp_s: float) -> JointSample:
    """Return a sensor_msgs/JointState; efforts may be missing and are then zero.

    Raises:
        DataError: If velocities are missing.
    """
    n = len(message.name)
    if len(message.velocity) != n:
        raise DataError(
            f"{n} joints with {len(message.velocity)} velocities; record the velocities too"
        )
    effort = np.array(message.effort) if len(message.effort) else np.zeros(n)
    return JointSample(
        stamp_s, tuple(message.name), np.array(message.position), np.array(message.velocity), effort
    )


def lidar_scan(message: Any, stamp_s: float) -> LidarScan:
    """Return a sensor_msgs/PointCloud2 with fields x, y, z and optionally a time of each point.

    Times of points count from the message's stamp. The stamp of the scan is that of its last point.
    Returns that are not finite are left out.

    Raises:
        DataError: If it has no x, y, z.
    """
    layout = {
        f.name: (_NUMPY[f.datatype], f.offset) for f in message.fields if f.datatype in _NUMPY
    }
    missing = [name for name in "xyz" if name not in layout]
    if missing:
        raise DataError(
            f"a point cloud without {', '.join(missing)}; its fields are "
            f"{', '.join(layout) or 'none'}"
        )
    formats, offsets = zip(*layout.values(), strict=True)
    kind = np.dtype(
        {
            "names": list(layout),
            "formats": formats,
            "offsets": offsets,
            "itemsize": message.point_step,
        }
    ).newbyteorder(">" if message.is_bigendian else "<")
    cloud = np.frombuffer(bytes(message.data), dtype=kind, count=message.width * message.height)
    points = np.column_stack([cloud[name].astype(float) for name in "xyz"])
    name = next((name for name in _TIMES if name in layout), None)
    after_s = cloud[name].astype(float) * _TIMES[name] if name else np.zeros(len(points))
    kept = np.isfinite(points).all(axis=1) & np.isfinite(after_s)
    order = np.argsort(after_s[kept], kind="stable")
    stamps_s = stamp_s + after_s[kept][order]
    end_s = float(stamps_s[-1]) if len(stamps_s) else stamp_s
    return LidarScan(end_s, message.header.frame_id, points[kept][order], stamps_s)


def pose_of(message: Any) -> Float:
    """Return a geometry_msgs/Pose, shape (4, 4)."""
    p = message.position
    return pose(_rotation(message.orientation), np.array([p.x, p.y, p.z]))


def transform_of(message: Any) -> Float:
    """Return a geometry_msgs/Transform, shape (4, 4)."""
    t = message.translation
    return pose(_rotation(message.rotation), np.array([t.x, t.y, t.z]))


def _rotation(q: Any) -> Float:
    q_wxyz = np.array([q.w, q.x, q.y, q.z])
    if not 0.9 < np.linalg.norm(q_wxyz) < 1.1:
        raise ShapeError(
            f"a quaternion of length {np.linalg.norm(q_wxyz):.3g}; a rotation has length 1"
        )
    return from_quaternion(q_wxyz)
