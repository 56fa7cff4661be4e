"""The noise of each channel has the standard deviation of the machine's sheet."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot.sensor_noise import SensorNoise

from executive.geometry.geodesy import enu_from_geodetic
from executive.machine.machine import load_machine
from executive.machine.sensor import Gnss, Imu
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan

COUNT = 2000
WITHIN = 0.12  # of a standard deviation: seven standard errors of its estimate
DATUM = np.array([47.4, 8.5, 440.0])
M545 = load_machine("m545")


def deviations(ideal, part) -> np.ndarray:
    """Return standard deviations and means of what noise adds, by component."""
    noise = SensorNoise(M545, np.random.default_rng(1))
    added = np.array([part(noise.on(ideal)) - part(ideal) for _ in range(COUNT)])
    assert np.abs(added.mean(axis=0)) == pytest.approx(0.0, abs=0.2 * added.std(axis=0).max())
    return added.std(axis=0)


def joints() -> JointSample:
    n = len(M545.joint_names)
    return JointSample(1.0, M545.joint_names, *np.arange(3.0 * n).reshape(3, n))


@pytest.mark.parametrize("name", [one for one, s in M545.sensors.items() if isinstance(s, Imu)])
def test_an_inertial_sensor(name: str) -> None:
    sheet = M545.sensors[name]
    ideal = ImuSample(1.0, name, np.ones(3), np.array([0.0, 0.0, 9.81]))
    rates = deviations(ideal, lambda sample: sample.angular_velocity_rad_s)
    forces = deviations(ideal, lambda sample: sample.specific_force_m_s2)
    assert rates == pytest.approx(np.full(3, sheet.gyro_noise_rad_s), rel=WITHIN)
    assert forces == pytest.approx(np.full(3, sheet.accel_noise_m_s2), rel=WITHIN)


def test_an_antenna() -> None:
    name, sheet = next((name, s) for name, s in M545.sensors.items() if isinstance(s, Gnss))
    ideal = GnssFix(1.0, name, DATUM, np.eye(3), True)
    std = deviations(ideal, lambda fix: enu_from_geodetic(fix.geodetic, DATUM))
    level, up = sheet.horizontal_noise_m, sheet.vertical_noise_m
    assert std == pytest.approx([level, level, up], rel=WITHIN)


def test_encoders() -> None:
    sheet = next(iter(M545.sensors_of("encoders")))
    all_joints = (*M545.joints, M545.jaw)
    std = deviations(joints(), lambda sample: sample.position)
    lengths = np.array([joint.kind == "prismatic" for joint in M545.joints] + [False])
    assert lengths.any()
    expected = np.where(lengths, sheet.length_noise_m, sheet.angle_noise_rad)
    assert std == pytest.approx(expected, rel=WITHIN)
    std = deviations(joints(), lambda sample: sample.velocity)
    assert std == pytest.approx(np.full(len(all_joints), sheet.velocity_noise), rel=WITHIN)
    std = deviations(joints(), lambda sample: sample.effort)
    efforts = [sheet.effort_noise * joint.max_effort for joint in all_joints]
    assert std == pytest.approx(efforts, rel=WITHIN)


def test_two_channels_of_a_sample_are_independent() -> None:
    name = next(name for name, s in M545.sensors.items() if isinstance(s, Imu))
    noise = SensorNoise(M545, np.random.default_rng(1))
    ideal = ImuSample(1.0, name, np.zeros(3), np.zeros(3))
    noisy = [noise.on(ideal) for _ in range(COUNT)]
    rows = [np.r_[s.angular_velocity_rad_s, s.specific_force_m_s2] for s in noisy]
    off = np.corrcoef(np.array(rows).T) - np.eye(6)
    assert np.abs(off).max() < 0.12


def test_what_a_machine_has_no_noisy_sensor_for_stays_as_it_is() -> None:
    """An antenna's name on an inertial sample, and the other way round; no encoders at all."""
    imu = next(name for name, s in M545.sensors.items() if isinstance(s, Imu))
    antenna = next(name for name, s in M545.sensors.items() if isinstance(s, Gnss))
    noise = SensorNoise(M545, np.random.default_rng(1))
    sample = ImuSample(1.0, antenna, np.ones(3), np.ones(3))
    fix = GnssFix(1.0, imu, DATUM, np.eye(3), True)
    scan = LidarScan(1.0, "lidar", np.zeros((0, 3)), np.zeros(0))
    for one in (sample, fix, scan):
        assert noise.on(one) is one
    bare = SimpleNamespace(sensors={}, sensors_of=lambda kind: ())
    of_joints = joints()
    assert SensorNoise(bare, np.random.default_rng(1)).on(of_joints) is of_joints
