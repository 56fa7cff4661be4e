"""Logs are read equally from every container, and errors name the place."""

from pathlib import Path

import numpy as np
import pytest

from executive.errors import DataError
from executive.logs.log import Log
from executive.logs.topics import Topics
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement


def read(path):
    return [arrival.observation for arrival in Log(path, Topics()).arrivals()]


def test_mcap_and_both_kinds_of_bag_hold_the_same(ros1, ros2, car, write_mcap, write_bag, tmp_path):
    logs = [
        read(write_mcap(tmp_path / "a.mcap", ros2, car(ros2, 1.0))),
        read(write_bag(tmp_path / "a.bag", ros1, car(ros1, 1.0))),
        read(write_bag(tmp_path / "a", ros2, car(ros2, 1.0))),
    ]
    for log in logs:
        assert [type(o) for o in log] == [type(o) for o in logs[0]]
        for one, other in zip(log, logs[0], strict=True):
            assert one.stamp_s == other.stamp_s
            if isinstance(one, ImuSample):
                np.testing.assert_array_equal(one.specific_force_m_s2, other.specific_force_m_s2)
    fix = next(o for o in logs[0] if isinstance(o, GnssFix))
    assert (fix.antenna, fix.is_rtk_fixed, fix.stamp_s) == ("gnss", True, 0.0)


def test_a_chain_of_static_transforms_becomes_extrinsics(car_log):
    rig = Log(car_log, Topics()).rig(None)
    np.testing.assert_allclose(rig.sensors["gnss"].T_link_sensor[:3, 3], [0.5, 0, 0], atol=1e-12)
    np.testing.assert_allclose(
        rig.sensors["imu"].T_link_sensor[:3, :3], np.diag([-1, -1, 1]), atol=1e-12
    )


def test_messages_without_a_fix_are_left_out_and_float_fixes_are_not_rtk(
    ros2, write_mcap, tmp_path
):
    messages = [
        (0.0, "/imu/data", ros2.imu(0.0, "imu", np.zeros(3), np.ones(3))),
        *[
            (0.1 + k, "/gnss/fix", ros2.fix(0.1 + k, "gnss", np.zeros(3), status))
            for k, status in enumerate((-1, 0, 2))
        ],
    ]
    fixes = [
        o for o in read(write_mcap(tmp_path / "a.mcap", ros2, messages)) if isinstance(o, GnssFix)
    ]
    assert [fix.is_rtk_fixed for fix in fixes] == [False, True]


def test_poses_of_an_odometry_become_increments(ros2, write_mcap, tmp_path):
    messages = [
        (0.0, "/imu/data", ros2.imu(0.0, "imu", np.zeros(3), np.ones(3))),
        (0.0, "/gnss/fix", ros2.fix(0.0, "gnss", np.zeros(3))),
        *[
            (k / 10, "/odometry", ros2.odometry(k / 10, "lidar", (k, 0, 0), (0, 0, 0, 1)))
            for k in range(3)
        ],
    ]
    increments = [
        o
        for o in read(write_mcap(tmp_path / "a.mcap", ros2, messages))
        if isinstance(o, LidarIncrement)
    ]
    assert [(round(i.from_s, 6), round(i.to_s, 6), i.frame) for i in increments] == [
        (0, 0.1, "lidar"),
        (0.1, 0.2, "lidar"),
    ]
    # The sensor looks back, so that a step ahead of the odometry frame is one behind its back.
    np.testing.assert_allclose(increments[0].T_from_to[:3, 3], [-1, 0, 0], atol=1e-12)


def damaged(path, kind):
    raw = path.read_bytes()
    if kind == "cut":
        return raw[: len(raw) // 2]
    if kind == "flipped":
        middle = len(raw) // 3
        return raw[:middle] + bytes([raw[middle] ^ 255]) + raw[middle + 1 :]
    return {"empty": b"", "text": b"stamp,x,y,z\n" * 50}[kind]


@pytest.mark.parametrize("suffix", ["mcap", "bag"])
@pytest.mark.parametrize("kind", ["cut", "flipped", "empty", "text"])
def test_a_damaged_file_is_refused_by_name(
    kind, suffix, ros1, ros2, car, write_mcap, write_bag, tmp_path
):
    whole = tmp_path / f"whole.{suffix}"
    if suffix == "mcap":
        write_mcap(whole, ros2, car(ros2, 1.0))
    else:
        write_bag(whole, ros1, car(ros1, 1.0))
    bad = tmp_path / f"bad.{suffix}"
    bad.write_bytes(damaged(whole, kind))
    if (suffix, kind) == ("bag", "flipped"):
        return  # a ROS 1 bag carries no checksum
    with pytest.raises(DataError, match="bad"):
        read(bad)


@pytest.mark.parametrize("use_chunking", [True, False])
@pytest.mark.parametrize("share", [0.3, 0.97])
def test_a_log_of_a_killed_recorder_is_read_up_to_the_cut(
    share, use_chunking, ros2, car, write_mcap, tmp_path, caplog
):
    messages = car(ros2, 2.0)
    options = {"chunk_size": 4000, "use_chunking": use_chunking}
    whole = write_mcap(tmp_path / "whole.mcap", ros2, messages, **options)
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: int(share * whole.stat().st_size)])
    told, log = Log(whole, Topics()), Log(cut, Topics())
    everything = [(a.arrival_s, type(a.observation)) for a in told.arrivals()]
    found = [(a.arrival_s, type(a.observation)) for a in log.arrivals()]
    assert told.cut is None
    assert found == everything[: len(found)]
    assert len(found) > 0.8 * share * len(everything)  # an index at the end takes some bytes
    assert log.cut is not None
    assert 0 < cut.stat().st_size - log.cut.read_bytes < 5000
    assert log.cut.until_s == pytest.approx(found[-1][0])
    assert "cut.mcap: cut off, as by a killed recorder: " in caplog.text
    assert f"until {log.cut.until_s:.3f} s" in caplog.text
    assert log.rig(None).sensors.keys() == told.rig(None).sensors.keys()


def test_zeros_at_the_end_of_a_log_are_a_cut(ros2, car, write_mcap, tmp_path):
    """A file system may have made the file longer before the power failed."""
    whole = write_mcap(tmp_path / "whole.mcap", ros2, car(ros2, 2.0), chunk_size=4000)
    content = whole.read_bytes()
    half = len(content) // 2
    (tmp_path / "zeros.mcap").write_bytes(content[:half] + bytes(half))
    log = Log(tmp_path / "zeros.mcap", Topics())
    assert log.cut is not None
    assert log.cut.read_bytes <= half
    assert len(list(log.arrivals())) > 50


def test_a_chunk_that_claims_more_than_a_chunk_can_be_is_refused(ros2, car, write_mcap, tmp_path):
    whole = write_mcap(tmp_path / "whole.mcap", ros2, car(ros2, 1.0))
    content = bytearray(whole.read_bytes())
    first = content.index(b"\x06", 8 + 9 + content[9])  # the kind of a chunk's record
    content[first + 9 + 16 : first + 9 + 24] = (24_000_000_000).to_bytes(8, "little")
    (tmp_path / "bomb.mcap").write_bytes(content)
    with pytest.raises(DataError, match=r"bomb\.mcap: .*a chunk of 24,000,000,000 bytes"):
        read(tmp_path / "bomb.mcap")


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"/imu/data": "/imu/raw"}, "no /imu/data for imu"),
        ({"/gnss/fix": "/fix"}, "no /gnss/fix for gnss"),
        (
            {"/imu/data": "/gnss/fix", "/gnss/fix": "/imu/data"},
            "is sensor_msgs/msg/NavSatFix; for imu",
        ),
    ],
)
def test_the_error_of_a_missing_topic_or_another_type_names_the_cure(
    change, says, ros2, car, write_mcap, tmp_path
):
    messages = [(t, change.get(topic, topic), message) for t, topic, message in car(ros2, 0.5)]
    with pytest.raises(DataError, match=says):
        read(write_mcap(tmp_path / "a.mcap", ros2, messages))


def test_messages_with_nan_are_left_out_and_counted(ros2, car, write_mcap, tmp_path):
    messages = list(car(ros2, 0.5))
    path = write_mcap(tmp_path / "good.mcap", ros2, messages)
    whole = list(Log(path, Topics()).arrivals())
    bad = [
        (0.6, "/imu/data", ros2.imu(0.6, "imu", (0, np.nan, 0), np.ones(3))),
        (0.7, "/imu/data", ros2.imu(0.7, "imu", np.zeros(3), (0, 0, np.inf))),
        (0.8, "/gnss/fix", ros2.fix(0.8, "gnss", (np.nan, 0, 0))),
    ]
    log = Log(write_mcap(tmp_path / "bad.mcap", ros2, [*messages, *bad]), Topics())
    assert len(list(log.arrivals())) == len(whole)
    assert {topic: (s.count, s.first_s) for topic, s in log.skipped.items()} == {
        "/imu/data": (2, 0.6),
        "/gnss/fix": (1, 0.8),
    }
    assert "not finite" in log.skipped["/imu/data"].reason


def test_an_invalid_odometry_pose_affects_only_its_two_increments(ros2, car, write_mcap, tmp_path):
    messages = list(car(ros2, 0.5))
    poses = [(0.0, 1.0), (0.1, 1.1), (0.2, np.nan), (0.3, 1.3)]
    messages += [
        (0.5 + t, "/odometry", ros2.odometry(t, "lidar", (x, 0, 0), (1, 0, 0, 0))) for t, x in poses
    ]
    messages.append((0.9, "/odometry", ros2.odometry(0.4, "lidar", (1.4, 0, 0), (0, 0, 0, 0))))
    log = Log(write_mcap(tmp_path / "a.mcap", ros2, messages), Topics())
    increments = [
        a.observation for a in log.arrivals() if isinstance(a.observation, LidarIncrement)
    ]
    assert [i.T_from_to[0, 3] for i in increments] == pytest.approx([0.1, 0.2])
    assert log.skipped["/odometry"].count == 2


def test_a_sensor_without_extrinsics_is_refused_with_its_frame(ros2, car, write_mcap, tmp_path):
    messages = [m for m in car(ros2, 0.5) if m[1] != "/tf_static"]
    path = write_mcap(tmp_path / "a.mcap", ros2, messages)
    with pytest.raises(DataError, match="--machine"):
        Log(path, Topics()).rig(None)
    tf = (0.0, "/tf_static", ros2.tf([("base", "imu", (0, 0, 0), (1, 0, 0, 0))]))
    path = write_mcap(tmp_path / "b.mcap", ros2, [tf, *messages])
    with pytest.raises(DataError, match="no frame 'gnss'"):
        Log(path, Topics()).rig(None)


def test_the_places_of_sensors_take_the_part_of_static_transforms(ros2, car, write_mcap, tmp_path):
    messages = [m for m in car(ros2, 0.5) if m[1] != "/tf_static"]
    log = Log(write_mcap(tmp_path / "a.mcap", ros2, messages), Topics())
    frames = {frame: kind for frame, kind in log._frames().items() if kind != "imu"}
    with pytest.raises(DataError, match=f"--lever {next(iter(frames))}:0,0,0"):
        log.rig(None)
    at = {frame: np.array([0.5 + i, 0.0, 1.2]) for i, frame in enumerate(frames)}
    rig = log.rig(None, at)
    for frame, xyz_m in at.items():
        assert rig.sensors[frame].xyz_m == tuple(xyz_m)
    (imu,) = rig.sensors_of("imu")
    assert (imu.xyz_m, imu.rpy_rad) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    with pytest.raises(DataError, match="the log has no sensor of the frame 'gsp'"):
        log.rig(None, at | {"gsp": np.zeros(3)})
    with pytest.raises(DataError, match="the log has no sensor of the frame 'imu'"):
        log.rig(None, at | {imu.name: np.zeros(3)})


def test_a_missing_log_is_refused():
    with pytest.raises(DataError, match="no such log"):
        Log(Path("nowhere.mcap"), Topics())


@pytest.mark.parametrize("name", ["a.MCAP", "a.bag", "a.log", "a"])
def test_an_mcap_file_is_known_by_how_it_begins(name, ros2, car, write_mcap, tmp_path):
    path = write_mcap(tmp_path / "a.mcap", ros2, car(ros2, 0.2))
    expected = len(read(path))
    assert len(read(path.rename(tmp_path / name))) == expected > 10


@pytest.mark.parametrize("kind", ["text", "folder"])
def test_what_is_no_log_is_not_called_a_damaged_one(kind, tmp_path):
    path = tmp_path / kind
    if kind == "folder":
        path.mkdir()
        (path / "mission.yaml").write_text("api: 1\n")
    else:
        path.write_text("1 2 3\n")
    with pytest.raises(DataError, match=r"neither an MCAP file nor a bag; give an \.mcap file"):
        Log(path, Topics())


def test_a_bag_whose_recorder_was_killed_is_told_how_to_be_repaired(ros2, car, write_bag, tmp_path):
    path = write_bag(tmp_path / "a", ros2, car(ros2, 0.2))
    (path / "metadata.yaml").unlink()
    with pytest.raises(DataError, match=r"damaged log: Expected metadata .*`ros2 bag reindex"):
        Log(path, Topics())


@pytest.mark.parametrize("value", [float("nan"), 3.0])
def test_a_static_transform_that_is_none_is_refused_by_name(value, ros2, car, write_mcap, tmp_path):
    messages = list(car(ros2, 0.2))
    tf = messages[0][2].transforms[2]
    (tf.transform.rotation if value == 3.0 else tf.transform.translation).x = value
    path = write_mcap(tmp_path / "turned.mcap", ros2, messages)
    with pytest.raises(DataError, match=r"turned\.mcap: tf_static holds what is no transform"):
        Log(path, Topics()).rig(None)
