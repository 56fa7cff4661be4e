"""What a calibration changes: descriptions of sensors, stamps and covariances."""

import numpy as np
import pytest

from executive.errors import ConfigError
from executive.estimate.calibration import Calibration, SensorCalibration
from executive.machine.machine import load_machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement

MACHINE = load_machine("m545")
FIX = GnssFix(1.0, "gnss_left", np.array([47.0, 8.0, 440.0]), np.diag([1.0, 2.0, 3.0]), True)
INCREMENT = LidarIncrement(1.0, 1.1, "lidar", np.eye(4), np.diag(np.arange(1.0, 7.0)))
IMU = ImuSample(1.0, "imu_cabin", np.zeros(3), np.ones(3))


def found(**sensors: dict[str, object]) -> Calibration:
    return Calibration(sensors={k: SensorCalibration(**v) for k, v in sensors.items()})


def test_covariances_are_multiplied_by_what_was_found_of_their_sensor() -> None:
    known = found(gnss_left={"covariance_scale": 4.0}, lidar={"covariance_scale": 0.5})
    fix, increment = known.scaled(FIX), known.scaled(INCREMENT)
    assert np.array_equal(fix.covariance_enu_m2, np.diag([4.0, 8.0, 12.0]))
    assert (fix.stamp_s, fix.antenna, fix.is_rtk_fixed) == (1.0, "gnss_left", True)
    assert np.array_equal(increment.covariance, 0.5 * INCREMENT.covariance)
    assert (increment.from_s, increment.to_s, increment.frame) == (1.0, 1.1, "lidar")


@pytest.mark.parametrize(
    "known", [found(), found(gnss_left={"rate_hz": 5.0}, lidar={"covariance_scale": 1.0})]
)
def test_what_was_not_found_stays_the_same_object(known: Calibration) -> None:
    for one in (FIX, INCREMENT, IMU):
        assert known.scaled(one) is one


def test_stamps_are_moved_back_by_how_late_they_are() -> None:
    known = found(imu_cabin={"stamp_late_s": 0.02}, lidar={"stamp_late_s": 0.0}, gnss_left={})
    assert [(one.sensor, one.seconds) for one in known.offsets] == [
        ("imu_cabin", -0.02),
        ("lidar", 0.0),
    ]


def test_the_doubt_of_the_antennas_clocks_is_the_largest_if_all_are_known() -> None:
    known = found(a={"stamp_std_s": 0.01}, b={"stamp_std_s": 0.03}, c={})
    assert known.clock_std_s(["a", "b"]) == 0.03
    assert known.clock_std_s(["a"]) == 0.01
    assert known.clock_std_s(["a", "c"]) is None
    assert known.clock_std_s(["a", "d"]) is None
    assert known.clock_std_s([]) is None


def test_mountings_and_noise_replace_those_of_the_machine() -> None:
    known = found(imu_cabin={"gyro_noise_rad_s": 0.25, "xyz_m": (1, 2, 3), "stamp_late_s": 1})
    sensors = known.applied(MACHINE).sensors
    assert sensors["imu_cabin"].gyro_noise_rad_s == 0.25
    assert tuple(sensors["imu_cabin"].xyz_m) == (1, 2, 3)
    assert sensors["imu_cabin"].rate_hz == MACHINE.sensors["imu_cabin"].rate_hz
    assert sensors["imu_base"] == MACHINE.sensors["imu_base"]
    assert found().applied(MACHINE) is MACHINE


def test_a_sensor_of_no_or_another_kind_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"has no sensor 'imu_cabn'\. Did you mean 'imu_cabin'"):
        found(imu_cabn={}).applied(MACHINE)
    told = "calibration: sensors.gnss_left.gyro_noise_rad_s: .*'gnss_left' is of the kind gnss"
    with pytest.raises(ConfigError, match=told):
        found(gnss_left={"gyro_noise_rad_s": 0.1}).applied(MACHINE)
