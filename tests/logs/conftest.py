"""Small logs, written in the test."""

from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer
from rosbags.rosbag1 import Writer as Bag1Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from executive.geometry.geodesy import geodetic_from_enu

DATUM = np.array([47.4084, 8.5106, 440.0])
START_NS = 1_700_000_000_000_000_000


class Ros:
    """Makes messages of one ROS generation."""

    def __init__(self, store):
        self.store = get_typestore(store)
        self.is_1 = store == Stores.ROS1_NOETIC
        if self.is_1:
            text = "geometry_msgs/TransformStamped[] transforms"
            self.store.register(get_types_from_msg(text, "tf2_msgs/msg/TFMessage"))

    def make(self, name, **fields):
        return self.store.types[name](**fields)

    def vector(self, values):
        return self.make(
            "geometry_msgs/msg/Vector3", x=float(values[0]), y=float(values[1]), z=float(values[2])
        )

    def turn(self, wxyz):
        w, x, y, z = map(float, wxyz)
        return self.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)

    def header(self, t_s, frame):
        ns = START_NS + round(1e9 * t_s)
        stamp = self.make("builtin_interfaces/msg/Time", sec=ns // 10**9, nanosec=ns % 10**9)
        sequence = {"seq": 0} if self.is_1 else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **sequence)

    def imu(self, t_s, frame, rate, force):
        return self.make(
            "sensor_msgs/msg/Imu",
            header=self.header(t_s, frame),
            orientation=self.turn((1, 0, 0, 0)),
            orientation_covariance=np.zeros(9),
            angular_velocity=self.vector(rate),
            angular_velocity_covariance=np.zeros(9),
            linear_acceleration=self.vector(force),
            linear_acceleration_covariance=np.zeros(9),
        )

    def fix(self, t_s, frame, p_map, status=2):
        geodetic = geodetic_from_enu(np.asarray(p_map, dtype=float), DATUM)
        return self.make(
            "sensor_msgs/msg/NavSatFix",
            header=self.header(t_s, frame),
            status=self.make("sensor_msgs/msg/NavSatStatus", status=status, service=1),
            latitude=geodetic[0],
            longitude=geodetic[1],
            altitude=geodetic[2],
            position_covariance=np.diag([1e-4] * 3).ravel(),
            position_covariance_type=2,
        )

    def odometry(self, t_s, frame, xyz, wxyz):
        point = self.make(
            "geometry_msgs/msg/Point", x=float(xyz[0]), y=float(xyz[1]), z=float(xyz[2])
        )
        pose = self.make("geometry_msgs/msg/Pose", position=point, orientation=self.turn(wxyz))
        twist = self.make(
            "geometry_msgs/msg/Twist", linear=self.vector((0, 0, 0)), angular=self.vector((0, 0, 0))
        )
        return self.make(
            "nav_msgs/msg/Odometry",
            header=self.header(t_s, "odom"),
            child_frame_id=frame,
            pose=self.make(
                "geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36)
            ),
            twist=self.make(
                "geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=np.zeros(36)
            ),
        )

    def tf(self, frames):
        transforms = [
            self.make(
                "geometry_msgs/msg/TransformStamped",
                header=self.header(0.0, parent),
                child_frame_id=child,
                transform=self.make(
                    "geometry_msgs/msg/Transform",
                    translation=self.vector(xyz),
                    rotation=self.turn(q),
                ),
            )
            for parent, child, xyz, q in frames
        ]
        return self.make("tf2_msgs/msg/TFMessage", transforms=transforms)


def _car(ros, seconds):
    """A car rests for 5 s, then accelerates eastwards by 1 m/s²; its IMU looks back, its antenna is
    0.5 m ahead.
    """
    rng = np.random.default_rng(1)
    yield (
        0.0,
        "/tf_static",
        ros.tf(
            [
                ("base", "imu", (0, 0, 0), (0, 0, 0, 1)),
                ("base", "roof", (0.2, 0, 0), (1, 0, 0, 0)),
                ("roof", "gnss", (0.3, 0, 0), (1, 0, 0, 0)),
            ]
        ),
    )
    for k in range(round(100 * seconds)):
        t = k / 100
        u = max(0.0, t - 5.0)
        if k % 25 == 0:
            yield (
                t,
                "/gnss/fix",
                ros.fix(t, "gnss", rng.normal(0, 0.005, 3) + [0.5 + 0.5 * u * u, 0, 0]),
            )
        force = np.array([-1.0 * (u > 0), 0, 9.81]) + rng.normal(0, 0.02, 3)
        yield t, "/imu/data", ros.imu(t, "imu", rng.normal(0, 0.002, 3), force)


def _write_mcap(path, ros, messages, **options):
    with path.open("wb") as file:
        writer = Writer(file, **options)
        writer.start()
        channels = {}
        for t_s, topic, message in messages:
            name = message.__msgtype__
            if topic not in channels:
                schema = writer.register_schema(name, "ros2msg", b"")
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            ns = START_NS + round(1e9 * t_s)
            writer.add_message(
                channels[topic], ns, bytes(ros.store.serialize_cdr(message, name)), ns
            )
        writer.finish()
    return path


def _write_bag(path, ros, messages):
    writer = (
        Bag1Writer(path)
        if ros.is_1
        else Bag2Writer(path, version=9, storage_plugin=StoragePlugin.SQLITE3)
    )
    serialize = ros.store.serialize_ros1 if ros.is_1 else ros.store.serialize_cdr
    with writer:
        connections = {}
        for t_s, topic, message in messages:
            name = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, name, typestore=ros.store)
            writer.write(connections[topic], START_NS + round(1e9 * t_s), serialize(message, name))
    return path


@pytest.fixture(scope="session")
def ros2():
    return Ros(Stores.ROS2_HUMBLE)


@pytest.fixture(scope="session")
def ros1():
    return Ros(Stores.ROS1_NOETIC)


@pytest.fixture(scope="session")
def car_log(ros2, tmp_path_factory) -> Path:
    return _write_mcap(tmp_path_factory.mktemp("logs") / "car.mcap", ros2, _car(ros2, 14.0))


@pytest.fixture
def car():
    return _car


@pytest.fixture(scope="session")
def write_mcap():
    return _write_mcap


@pytest.fixture
def write_bag():
    return _write_bag
