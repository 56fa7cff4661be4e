"""An outage is read from `SENSOR:FROM:TO`, and takes the measurements of its sensor alone."""

import numpy as np
import pytest

from executive.errors import ConfigError
from executive.estimate.drop import Drop, is_of
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample


def fix(stamp_s):
    return GnssFix(stamp_s, "top", np.zeros(3), np.eye(3), True)


def test_an_outage_is_read_with_its_times():
    assert Drop.parse("gnss:120:165.5") == Drop("gnss", 120.0, 165.5)
    assert Drop.parse("left:lidar:1:2") == Drop("left:lidar", 1.0, 2.0)


@pytest.mark.parametrize(
    ("text", "told"),
    [("gnss", "is not SENSOR:FROM:TO"), ("gnss:1", "is not SENSOR:FROM:TO"),
     ("gnss:a:2", "is not SENSOR:FROM:TO"), ("gnss:2:1", "ends before it begins"),
     ("gnss:2:2", "ends before it begins"), ("gnss:nan:2", "ends before it begins")],
)  # fmt: skip
def test_what_is_no_outage_is_refused(text, told):
    with pytest.raises(ConfigError, match=told):
        Drop.parse(text)


@pytest.mark.parametrize(
    ("stamp_s", "is_taken"), [(0.9, False), (1.0, True), (1.9, True), (2.0, False)]
)
def test_an_outage_lasts_from_its_beginning_to_before_its_end(stamp_s, is_taken):
    assert Drop("gnss", 1.0, 2.0).takes(fix(stamp_s)) == is_taken
    assert not Drop("imu", 1.0, 2.0).takes(fix(stamp_s))


def test_a_sensor_is_named_by_its_kind_or_its_frame():
    sample = ImuSample(1.0, "imu_cabin", np.zeros(3), np.zeros(3))
    assert [is_of(fix(1.0), name) for name in ("gnss", "top", "bottom", "")] == [1, 1, 0, 0]
    assert [is_of(sample, name) for name in ("imu", "imu_cabin", "gnss")] == [1, 1, 0]
