"""Recorded observations are read back: values, order, machine."""

import numpy as np
import pytest

from executive.errors import ConfigError
from executive.logs.log import Log
from executive.logs.recorder import Recorder
from executive.logs.topics import Topics
from executive.machine.machine import load_machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan


@pytest.fixture
def recorded(tmp_path):
    rng = np.random.default_rng(1)
    names = load_machine("m545").joint_names
    observations = [
        ImuSample(0.03, "imu_cabin", rng.normal(size=3), rng.normal(size=3)),
        GnssFix(
            0.01, "gnss_left", np.array([47.4, 8.5, 440.0]), np.diag([1e-4, 2e-4, 3e-4]), False
        ),
        JointSample(0.04, names, *rng.normal(size=(3, len(names)))),
        LidarScan(0.05, "lidar_vertical", rng.normal(size=(50, 3)), np.linspace(0.01, 0.05, 50)),
    ]
    recorder = Recorder(tmp_path / "run.mcap", load_machine("m545"), "m545")
    recorder.write(observations, 0.05)
    recorder.close()
    return observations, Log(tmp_path / "run.mcap", Topics())


def test_every_kind_of_observation_comes_back(recorded):
    observations, log = recorded
    read = [arrival.observation for arrival in log.arrivals()]
    assert [type(o) for o in read] == [type(o) for o in observations]
    for one, other in zip(read, observations, strict=True):
        for name in other.__slots__:
            expected = getattr(other, name)
            # Points are written as 32-bit floats, stamps in nanoseconds.
            if isinstance(expected, np.ndarray | float):
                np.testing.assert_allclose(getattr(one, name), expected, atol=1e-6)
            else:
                assert getattr(one, name) == expected


def test_the_log_names_its_machine_and_when_things_came(recorded):
    _, log = recorded
    assert log.rig(None).name == load_machine("m545").name
    assert [arrival.arrival_s for arrival in log.arrivals()] == pytest.approx([0.05] * 4)


def test_a_missing_folder_is_named_in_the_error(tmp_path):
    with pytest.raises(ConfigError, match="--record-log"):
        Recorder(tmp_path / "no" / "run.mcap", load_machine("m545"), "m545")


def test_an_orientation_that_was_not_measured_is_marked_as_ros_says(recorded):
    """sensor_msgs/Imu: a first element of -1 in the covariance means that there is no estimate."""
    _, log = recorded
    (message,) = [
        found.message
        for found in log._source.messages(list(log._topics))
        if hasattr(found.message, "orientation_covariance")
    ]
    assert message.orientation_covariance[0] == -1.0
