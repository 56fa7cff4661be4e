"""An offset shifts every stamp of its sensor's observations, and nothing else."""

from dataclasses import fields

import numpy as np
import pytest

from executive.estimate.offset import Offset
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement

OBSERVATIONS = {
    "imu": ImuSample(3.0, "imu_cabin", np.array([0.1, 0.2, 0.3]), np.array([0, 0, 9.81])),
    "gnss": GnssFix(3.0, "gnss_left", np.array([47.0, 8.0, 440.0]), np.eye(3), True),
    "joints": JointSample(3.0, ("J_TURN",), np.ones(1), np.ones(1), np.ones(1)),
    "scan": LidarScan(3.0, "lidar_front", np.ones((2, 3)), np.array([2.9, 3.0])),
    "increment": LidarIncrement(2.9, 3.0, "lidar_front", np.eye(4), np.eye(6)),
}
STAMPS = ("stamp_s", "from_s", "to_s", "point_stamps_s")


@pytest.mark.parametrize("kind", OBSERVATIONS)
@pytest.mark.parametrize("seconds", [0.25, -0.5])
def test_all_stamps_move_by_the_offset_and_no_other_value_changes(kind, seconds) -> None:
    before = OBSERVATIONS[kind]
    sensor = "lidar" if kind in ("scan", "increment") else kind
    after = Offset(sensor, seconds).applied(before)
    assert type(after) is type(before)
    for field in fields(before):
        old, new = getattr(before, field.name), getattr(after, field.name)
        if field.name in STAMPS:
            np.testing.assert_allclose(np.subtract(new, old), seconds, atol=1e-12)
        else:
            np.testing.assert_array_equal(new, old)


@pytest.mark.parametrize("kind", OBSERVATIONS)
def test_an_offset_of_another_sensor_returns_the_same_observation(kind) -> None:
    other = "imu" if kind == "gnss" else "gnss"
    assert Offset(other, 0.25).applied(OBSERVATIONS[kind]) is OBSERVATIONS[kind]


def test_an_offset_and_its_opposite_cancel() -> None:
    for observation in OBSERVATIONS.values():
        there = Offset("lidar_front", 0.25).applied(observation)
        back = Offset("lidar_front", -0.25).applied(there)
        for field in fields(observation):
            np.testing.assert_array_equal(
                getattr(back, field.name), getattr(observation, field.name)
            )
