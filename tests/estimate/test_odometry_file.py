"""States are exported as CSV and as nav_msgs/Odometry, each number in its place and order."""

import csv

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from executive.errors import ConfigError
from executive.estimate.odometry_file import check_format, write_states
from executive.messages.base_state import BaseState

ORIGIN_S = 1_700_000_000.0
TURN = Rotation.from_euler("zyx", [0.9, -0.2, 0.1])
PLACE, V_MAP, W_CABIN = np.array([1.0, -2.0, 3.5]), np.array([0.4, 0.5, -0.6]), np.array([7, 8, 9])


def covariance():
    """A covariance of (rotation, translation) of which no two elements are equal."""
    spread = np.random.default_rng(4).normal(size=(6, 6))
    return spread @ spread.T


@pytest.fixture
def state():
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = TURN.as_matrix(), PLACE
    return BaseState(0.25, np.eye(4), np.eye(4), T, V_MAP, W_CABIN, covariance(), "GLOBAL")


def by_axis(P):
    """Return covariances by the names of two axes, from one of (rotation, translation)."""
    names = ("rx", "ry", "rz", "x", "y", "z")
    return {(a, b): P[i, j] for i, a in enumerate(names) for j, b in enumerate(names)}


def test_the_columns_of_a_csv_are_what_their_names_say(tmp_path, state):
    path = tmp_path / "states.csv"
    write_states(path, [state, state], ORIGIN_S, "cabin")
    first, second = csv.DictReader(path.read_text().splitlines())
    assert first == second
    assert first.pop("status") == "GLOBAL"
    told = {name: float(cell) for name, cell in first.items()}
    assert told["stamp_s"] == pytest.approx(ORIGIN_S + 0.25)
    assert [told[f"{axis}_m"] for axis in "xyz"] == pytest.approx(PLACE)
    turn = Rotation.from_quat([told[f"q{axis}"] for axis in "xyzw"])
    assert (turn.inv() * TURN).magnitude() < 1e-7
    assert [told[f"v{axis}_m_s"] for axis in "xyz"] == pytest.approx(V_MAP)
    assert [told[f"w{axis}_rad_s"] for axis in "xyz"] == pytest.approx(W_CABIN)
    expected = by_axis(covariance())
    columns = [name for name in told if name.startswith("cov_")]
    assert len(columns) == 21
    for name in columns:
        assert told[name] == pytest.approx(expected[tuple(name.split("_")[1:])])


def test_a_message_has_the_axes_and_the_order_that_ros_asks_for(tmp_path, state):
    from mcap.reader import make_reader
    from rosbags.typesys import Stores, get_typestore

    path = tmp_path / "states.mcap"
    write_states(path, [state], ORIGIN_S, "cabin")
    store = get_typestore(Stores.ROS2_HUMBLE)
    with path.open("rb") as file:
        ((schema, channel, raw),) = make_reader(file).iter_messages()
    assert (schema.name, channel.topic) == ("nav_msgs/msg/Odometry", "/odometry/map")
    message = store.deserialize_cdr(raw.data, schema.name)
    stamp = message.header.stamp
    assert raw.log_time == 10**9 * stamp.sec + stamp.nanosec
    assert raw.log_time == pytest.approx(1_700_000_000_250_000_000, abs=1000, rel=0)
    assert (message.header.frame_id, message.child_frame_id) == ("map", "cabin")
    at, q = message.pose.pose.position, message.pose.pose.orientation
    assert (at.x, at.y, at.z) == pytest.approx(tuple(PLACE))
    assert (Rotation.from_quat([q.x, q.y, q.z, q.w]).inv() * TURN).magnitude() < 1e-7
    P = message.pose.covariance.reshape(6, 6)
    expected = by_axis(covariance())
    names = ("x", "y", "z", "rx", "ry", "rz")
    for i, a in enumerate(names):
        for j, b in enumerate(names):
            assert P[i, j] == pytest.approx(expected[a, b])
    v, w = message.twist.twist.linear, message.twist.twist.angular
    assert (v.x, v.y, v.z) == pytest.approx(tuple(TURN.inv().apply(V_MAP)))
    assert (w.x, w.y, w.z) == pytest.approx(tuple(W_CABIN))


@pytest.mark.parametrize("name", ["states.csv", "states.mcap"])
def test_a_file_that_cannot_be_written_is_told(tmp_path, state, name):
    check_format(tmp_path / name)
    with pytest.raises(ConfigError, match=f"{name} cannot be written: No such file"):
        write_states(tmp_path / "none" / name, [state], ORIGIN_S, "cabin")


def test_another_suffix_is_refused(tmp_path):
    with pytest.raises(ConfigError, match=r"must end with \.csv or \.mcap"):
        check_format(tmp_path / "states.txt")
