"""States with velocity and covariance as files: CSV, and nav_msgs/Odometry in MCAP."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.errors import ConfigError
from executive.geometry.rotation import quaternion_wxyz
from executive.messages.base_state import BaseState

_FORMATS = (".csv", ".mcap")
_TOPIC, _TYPE = "/odometry/map", "nav_msgs/msg/Odometry"
_POSITION_FIRST = np.r_[3:6, 0:3]  # the order of ROS, and of the columns
_AXES = ("x", "y", "z", "rx", "ry", "rz")
_COLUMNS = (
    *("stamp_s", "status", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"),
    *("vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s"),
    *(f"cov_{a}_{b}" for i, a in enumerate(_AXES) for b in _AXES[i:]),
)


def check_format(path: Path) -> None:
    """Check that the suffix of a file names a format.

    Raises:
        ConfigError: If it is another.
    """
    if path.suffix not in _FORMATS:
        raise ConfigError(f"--export {path}: its name must end with {' or '.join(_FORMATS)}")


def write_states(path: Path, states: Sequence[BaseState], origin_s: float, body: str) -> None:
    """Write the cabin's states to a file whose suffix names the format.

    Pose: in the map (east, north, up). CSV: velocity in map axes, angular velocity and covariance
    in the cabin's. MCAP: all but the pose in the cabin's, as nav_msgs/Odometry demands.

    Args:
        path: The file.
        states: The states.
        origin_s: Time since 1970 from which their stamps count [s].
        body: Name of the cabin's frame.

    Raises:
        ConfigError: If the file cannot be written.
    """
    try:
        if path.suffix == ".csv":
            _write_csv(path, states, origin_s)
        else:
            _write_mcap(path, states, origin_s, body)
    except OSError as error:
        raise ConfigError(f"--export: {path} cannot be written: {error.strerror}") from error


def _covariance(state: BaseState) -> Float:
    return np.asarray(state.covariance[np.ix_(_POSITION_FIRST, _POSITION_FIRST)])


def _write_csv(path: Path, states: Sequence[BaseState], origin_s: float) -> None:
    upper = np.triu_indices(6)
    with path.open("w", encoding="utf-8") as file:
        file.write(",".join(_COLUMNS) + "\n")
        for state in states:
            w, x, y, z = quaternion_wxyz(state.T_map_cabin[:3, :3])
            pose = (*state.T_map_cabin[:3, 3], x, y, z, w)
            numbers = [*pose, *state.v_map_cabin, *state.w_map_cabin_in_cabin]
            numbers += list(_covariance(state)[upper])
            cells = (
                f"{origin_s + state.stamp_s:.6f}",
                state.status,
                *(f"{v:.9g}" for v in numbers),
            )
            file.write(",".join(cells) + "\n")


def _write_mcap(path: Path, states: Sequence[BaseState], origin_s: float, body: str) -> None:
    from mcap.writer import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    text, _ = store.generate_msgdef(_TYPE, ros_version=2)
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema(_TYPE, "ros2msg", text.encode())
        channel = writer.register_channel(_TOPIC, "cdr", schema)
        for state in states:
            ns = round(1e9 * (origin_s + state.stamp_s))
            data = bytes(store.serialize_cdr(_message(store.types, state, ns, body), _TYPE))
            writer.add_message(channel, ns, data, ns)
        writer.finish()


def _message(types: Any, state: BaseState, ns: int, body: str) -> Any:
    """Return a nav_msgs/Odometry; the covariance of the twist is not estimated, and zero."""
    geometry = "geometry_msgs/msg/"

    def vector(v: Float, name: str = "Vector3") -> Any:
        x, y, z = map(float, v)
        return types[geometry + name](x=x, y=y, z=z)

    R, P = state.T_map_cabin[:3, :3], _covariance(state).ravel()
    w, x, y, z = map(float, quaternion_wxyz(R))
    stamp = types["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)
    pose = types[geometry + "Pose"](
        position=vector(state.T_map_cabin[:3, 3], "Point"),
        orientation=types[geometry + "Quaternion"](x=x, y=y, z=z, w=w),
    )
    twist = types[geometry + "Twist"](
        linear=vector(R.T @ state.v_map_cabin), angular=vector(state.w_map_cabin_in_cabin)
    )
    return types[_TYPE](
        header=types["std_msgs/msg/Header"](stamp=stamp, frame_id="map"),
        child_frame_id=body,
        pose=types[geometry + "PoseWithCovariance"](pose=pose, covariance=P),
        twist=types[geometry + "TwistWithCovariance"](twist=twist, covariance=np.zeros(36)),
    )
