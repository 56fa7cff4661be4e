"""Recording of observations as ROS messages in an MCAP file, one topic for each kind."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.errors import ConfigError
from executive.extras import require_extra
from executive.geometry.rotation import quaternion_wxyz
from executive.logs.topics import METADATA, TYPES, Topics
from executive.machine.rig import Rig
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation

# Time of a point is in seconds after the header's stamp.
_POINT = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("time", "<f4")])
_FLOAT32 = 7  # sensor_msgs/PointField
_RTK, _FLOAT, _GPS, _COVARIANCE_KNOWN = 2, 0, 1, 3  # sensor_msgs/NavSatStatus and NavSatFix


class Recorder:
    """A log that is being written; it must be ended with `close`."""

    def __init__(self, path: Path, machine: Rig, model: str) -> None:
        """Start a log with the machine's name and the mounting of its sensors.

        Raises:
            MissingExtraError: If the packages that write logs are not installed.
            ConfigError: If the file cannot be written.
        """
        require_extra("--record-log", "logs")
        from mcap.writer import Writer
        from rosbags.typesys import Stores, get_typestore

        try:
            self._writer = Writer(str(path))
        except OSError as error:
            raise ConfigError(
                f"--record-log: {path} cannot be written: {error.strerror}"
            ) from error
        self._store = get_typestore(Stores.ROS2_HUMBLE)
        self._topics: Mapping[str, str] = Topics().model_dump()
        self._channels: dict[str, int] = {}
        self._writer.start()
        self._writer.add_metadata(METADATA, {"machine": model})
        self._add("tf_static", 0, self._extrinsics(machine))

    def write(self, observations: Sequence[Observation], now_s: float) -> None:
        """Append observations with their time of arrival [s]."""
        kinds = {ImuSample: "imu", GnssFix: "gnss", JointSample: "joints", LidarScan: "points"}
        makers: Mapping[type, Any] = {
            ImuSample: self._imu,
            GnssFix: self._fix,
            JointSample: self._joints,
            LidarScan: self._scan,
        }
        for observation in observations:
            kind = type(observation)
            self._add(kinds[kind], _ns(now_s), makers[kind](observation))

    def close(self) -> None:
        """Write the summary; without it the file is incomplete."""
        self._writer.finish()

    def _add(self, kind: str, arrival_ns: int, message: Any) -> None:
        if kind not in self._channels:
            text, _ = self._store.generate_msgdef(TYPES[kind], ros_version=2)
            schema = self._writer.register_schema(TYPES[kind], "ros2msg", text.encode())
            self._channels[kind] = self._writer.register_channel(self._topics[kind], "cdr", schema)
        data = bytes(self._store.serialize_cdr(message, TYPES[kind]))
        self._writer.add_message(self._channels[kind], arrival_ns, data, arrival_ns)

    def _make(self, name: str, /, **fields: Any) -> Any:
        return self._store.types[name](**fields)

    def _header(self, stamp_s: float, frame: str) -> Any:
        sec, nanosec = divmod(_ns(stamp_s), 1_000_000_000)
        stamp = self._make("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)
        return self._make("std_msgs/msg/Header", stamp=stamp, frame_id=frame)

    def _vector(self, v: Float) -> Any:
        return self._make("geometry_msgs/msg/Vector3", x=float(v[0]), y=float(v[1]), z=float(v[2]))

    def _turn(self, q_wxyz: Float) -> Any:
        w, x, y, z = map(float, q_wxyz)
        return self._make("geometry_msgs/msg/Quaternion", w=w, x=x, y=y, z=z)

    def _imu(self, sample: ImuSample) -> Any:
        return self._make(
            TYPES["imu"],
            header=self._header(sample.stamp_s, sample.frame),
            orientation=self._turn(np.array([1.0, 0.0, 0.0, 0.0])),
            orientation_covariance=np.array([-1.0, *[0.0] * 8]),  # not measured
            angular_velocity=self._vector(sample.angular_velocity_rad_s),
            angular_velocity_covariance=np.zeros(9),
            linear_acceleration=self._vector(sample.specific_force_m_s2),
            linear_acceleration_covariance=np.zeros(9),
        )

    def _fix(self, fix: GnssFix) -> Any:
        status = _RTK if fix.is_rtk_fixed else _FLOAT
        return self._make(
            TYPES["gnss"],
            header=self._header(fix.stamp_s, fix.antenna),
            status=self._make("sensor_msgs/msg/NavSatStatus", status=status, service=_GPS),
            latitude=float(fix.geodetic[0]),
            longitude=float(fix.geodetic[1]),
            altitude=float(fix.geodetic[2]),
            position_covariance=fix.covariance_enu_m2.ravel(),
            position_covariance_type=_COVARIANCE_KNOWN,
        )

    def _joints(self, sample: JointSample) -> Any:
        return self._make(
            TYPES["joints"],
            header=self._header(sample.stamp_s, ""),
            name=list(sample.names),
            position=np.array(sample.position),
            velocity=np.array(sample.velocity),
            effort=np.array(sample.effort),
        )

    def _scan(self, scan: LidarScan) -> Any:
        n = len(scan.points_lidar)
        first_s = float(scan.point_stamps_s[0]) if n else scan.stamp_s
        cloud = np.empty(n, dtype=_POINT)
        for i, name in enumerate("xyz"):
            cloud[name] = scan.points_lidar[:, i]
        cloud["time"] = scan.point_stamps_s - first_s
        fields = [
            self._make(
                "sensor_msgs/msg/PointField", name=name, offset=4 * i, datatype=_FLOAT32, count=1
            )
            for i, name in enumerate(_POINT.names or ())
        ]
        return self._make(
            TYPES["points"],
            header=self._header(first_s, scan.frame),
            height=1,
            width=n,
            fields=fields,
            is_bigendian=False,
            point_step=_POINT.itemsize,
            row_step=n * _POINT.itemsize,
            data=np.frombuffer(cloud.tobytes(), dtype=np.uint8),
            is_dense=True,
        )

    def _extrinsics(self, machine: Rig) -> Any:
        transforms = [
            self._make(
                "geometry_msgs/msg/TransformStamped",
                header=self._header(0.0, sensor.link),
                child_frame_id=name,
                transform=self._make(
                    "geometry_msgs/msg/Transform",
                    translation=self._vector(sensor.T_link_sensor[:3, 3]),
                    rotation=self._turn(quaternion_wxyz(sensor.T_link_sensor[:3, :3])),
                ),
            )
            for name, sensor in machine.sensors.items()
        ]
        return self._make(TYPES["tf_static"], transforms=transforms)


def _ns(time_s: float) -> int:
    return round(1e9 * time_s)
