"""A reference covers the times between its poses, and a file of it is read line by line."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from executive.errors import ConfigError, DataError
from executive.estimate.trajectory import Trajectory, read_trajectory

STAMPS_S = np.array([0.0, 1.0, 2.0, 4.5, 5.5, 8.2, 9.2])  # a usual interval of 1 s, one of 2.7 s
HALF = np.sqrt(0.5)


def way():
    turns = Rotation.from_euler("z", 0.1 * STAMPS_S[:, None])
    return Trajectory(STAMPS_S, np.outer(STAMPS_S, (1.0, 2.0, 3.0)), turns.as_matrix())


@pytest.mark.parametrize(
    ("at_s", "is_covered"),
    [(-0.1, False), (0.5, True), (1.0, True), (3.0, True), (6.0, False), (9.2, True), (9.3, False)],
)
def test_a_time_is_covered_by_a_pose_shortly_before_and_one_after(at_s, is_covered):
    assert way().covers(np.array([at_s])).tolist() == [is_covered]


def test_poses_between_two_are_interpolated():
    at_s = np.array([0.25, 3.0, 9.0])
    between = way().at(at_s)
    assert between.stamps_s == pytest.approx(at_s)
    assert between.p == pytest.approx(np.outer(at_s, (1.0, 2.0, 3.0)))
    turn = Rotation.from_matrix(between.R) * Rotation.from_euler("z", 0.1 * at_s[:, None]).inv()
    assert turn.magnitude() == pytest.approx(0.0, abs=1e-7)


def test_positions_with_one_orientation_have_none():
    assert way().has_orientation
    same = np.tile(way().R[2], (len(STAMPS_S), 1, 1))
    assert not Trajectory(STAMPS_S, way().p, same).has_orientation


def read(tmp_path, *lines):
    path = tmp_path / "reference.txt"
    path.write_text("\n".join(lines) + "\n")
    return read_trajectory(path, None)


def test_a_file_is_read_in_order_of_time_without_repeated_stamps(tmp_path):
    found = read(
        tmp_path,
        "# stamp x y z qx qy qz qw",
        f"2 4 5 6 0 0 {HALF} {HALF}",
        "",
        "1 1 2 3 0 0 0 1",
        "1 9 9 9 0 0 0 1",
    )
    assert found.stamps_s.tolist() == [1.0, 2.0]
    assert found.p.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert found.R[1] == pytest.approx(Rotation.from_euler("z", np.pi / 2).as_matrix())


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("2 4 5 6 0 0 0", "txt:2: expected eight numbers"),
        ("2 4 5 6 0 0 0 1 1", "txt:2: expected eight numbers"),
        ("2 4 5 x 0 0 0 1", "txt:2: expected eight numbers"),
        ("2 4 5 nan 0 0 0 1", "txt:2: expected eight numbers"),
        ("2 4 5 6 0 0 0 0.89", "txt:2: a quaternion of length 0.89"),
        ("2 4 5 6 0 0 0 1.11", "txt:2: a quaternion of length 1.11"),
        ("# nothing", "1 poses; a reference needs two at least"),
    ],
)
def test_a_line_that_is_no_pose_is_told_with_its_number(tmp_path, line, told):
    with pytest.raises(DataError, match=told):
        read(tmp_path, "1 1 2 3 0 0 0 1", line)


def test_quaternions_may_be_rounded(tmp_path):
    found = read(tmp_path, "1 1 2 3 0 0 0 0.91", "2 1 2 3 0 0 0 1.09")
    assert pytest.approx(np.tile(np.eye(3), (2, 1, 1))) == found.R


def test_a_file_that_is_not_there_or_has_no_topics_is_told(tmp_path):
    with pytest.raises(DataError, match="cannot be read as a TUM file"):
        read_trajectory(tmp_path / "none.txt", None)
    with pytest.raises(ConfigError, match="is no log; leave the option out"):
        read_trajectory(tmp_path / "none.txt", "/pose")


class Log:
    """A log of topics, with messages at a tenth of a second from one another."""

    path = "site.mcap"

    def __init__(self, **types):
        self.types, self.asked = types, []

    def messages(self, topics):
        self.asked.append(topics)
        kind = self.types[topics[0]]
        for number in (2, 1):
            position = SimpleNamespace(x=1.0 * number, y=2.0 * number, z=3.0 * number)
            orientation = SimpleNamespace(x=0.0, y=0.0, z=HALF, w=HALF)
            found = SimpleNamespace(position=position, orientation=orientation)
            stamp = SimpleNamespace(sec=7, nanosec=100_000_000 * number)
            header = SimpleNamespace(stamp=stamp)
            if not kind.endswith("PoseStamped"):
                found = SimpleNamespace(pose=found)
            yield SimpleNamespace(message=SimpleNamespace(header=header, pose=found))


STAMPED, ODOMETRY = "geometry_msgs/msg/PoseStamped", "nav_msgs/msg/Odometry"


@pytest.mark.parametrize(
    ("kind", "topic"),
    [
        (STAMPED, None),
        (ODOMETRY, "truth"),
        ("geometry_msgs/msg/PoseWithCovarianceStamped", None),
    ],
)
def test_poses_of_a_log_are_read_from_the_one_topic_that_has_them(monkeypatch, kind, topic):
    log = Log(imu="sensor_msgs/msg/Imu", truth=kind)
    monkeypatch.setattr("executive.estimate.trajectory.LogSource", lambda path: log)
    found = read_trajectory(Path("site.mcap"), topic)
    assert log.asked == [["truth"]]
    assert found.stamps_s == pytest.approx([7.1, 7.2])
    assert found.p == pytest.approx(np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0]]))
    assert found.R[0] == pytest.approx(Rotation.from_euler("z", np.pi / 2).as_matrix())


@pytest.mark.parametrize(
    ("types", "topic", "told"),
    [
        ({"b": STAMPED, "a": ODOMETRY}, None, "name one by --score-topic; .* there: a, b"),
        ({"imu": "sensor_msgs/msg/Imu"}, None, "name one by --score-topic; .* there: none"),
        ({"imu": "sensor_msgs/msg/Imu", "a": ODOMETRY}, "imu", "names no topic .* there: a"),
        ({"a": ODOMETRY}, "b", "names no topic of poses; .* there: a"),
    ],
)
def test_a_topic_without_poses_and_a_choice_that_is_not_made_are_refused(
    monkeypatch, types, topic, told
):
    log = Log(**types)
    monkeypatch.setattr("executive.estimate.trajectory.LogSource", lambda path: log)
    with pytest.raises(ConfigError, match=f"site.mcap: .*{told}"):
        read_trajectory(Path("site.mcap"), topic)
