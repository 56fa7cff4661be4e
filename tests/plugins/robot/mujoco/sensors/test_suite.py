"""Rates, latencies, noise and drop-outs of the sensors, measured; the motion is prescribed, so the
truth is known.
"""

from collections.abc import Iterator

import mujoco
import numpy as np
import pytest
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.sensors.settings import SensorSettings
from executive_plugins.robot.mujoco.sensors.suite import SensorSuite
from executive_plugins.robot.mujoco.site.settings import TerrainSettings
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.terrain import make_terrain
from executive_plugins.robot.mujoco.world import World

from executive.errors import ConfigError
from executive.geometry.geodesy import enu_from_geodetic
from executive.machine.machine import Machine, load_machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation

MACHINE = load_machine("m545")
STEP_S = 0.01
FLAT = Site(
    make_terrain(TerrainSettings(undulation_m=0, roughness_m=0), np.random.default_rng(0)), (), ()
)
WORLD = World(MACHINE, FLAT, PhysicsSettings())


def measure(
    duration_s: float,
    rate_rad_s: float = 0.0,
    seed: int = 0,
    machine: Machine = MACHINE,
    lidars: bool = False,
    **settings: object,
) -> list[tuple[float, Observation]]:
    """Turn the cabin at a constant rate and return (time of arrival, observation)."""
    chosen = SensorSettings.model_validate(settings)
    suite = SensorSuite(machine, FLAT, chosen, WORLD.model, np.random.default_rng(seed))
    suite.lidars_on = lidars
    return list(_steps(suite, duration_s, rate_rad_s))


def _steps(
    suite: SensorSuite, duration_s: float, rate_rad_s: float
) -> Iterator[tuple[float, Observation]]:
    data = mujoco.MjData(WORLD.model)
    data.qpos[:] = WORLD.data.qpos
    for k in range(1, round(duration_s / STEP_S) + 1):
        data.joint("J_TURN").qpos = rate_rad_s * k * STEP_S
        data.joint("J_TURN").qvel = rate_rad_s
        yield from (
            (k * STEP_S, observation) for observation in suite.step(k * STEP_S, WORLD.model, data)
        )


def imu(samples: list[tuple[float, Observation]], frame: str) -> list[ImuSample]:
    return [o for _, o in samples if isinstance(o, ImuSample) and o.frame == frame]


def test_an_imu_at_rest_measures_gravity_upwards_within_its_bias_and_noise() -> None:
    samples = imu(measure(20), "imu_cabin")
    force = np.array([sample.specific_force_m_s2 for sample in samples])
    rate = np.array([sample.angular_velocity_rad_s for sample in samples])
    sensor = MACHINE.sensors["imu_cabin"]
    # Four standard deviations of the start-up bias; white noise of 2,000 samples is good to 5 %.
    assert np.abs(force.mean(axis=0) - [0, 0, 9.81]).max() < 4 * sensor.accel_bias_m_s2
    assert np.abs(rate.mean(axis=0)).max() < 4 * sensor.gyro_bias_rad_s
    assert np.allclose(
        np.diff(force, axis=0).std(axis=0) / np.sqrt(2), sensor.accel_noise_m_s2, rtol=0.06
    )
    assert np.allclose(
        np.diff(rate, axis=0).std(axis=0) / np.sqrt(2), sensor.gyro_noise_rad_s, rtol=0.06
    )


def test_an_imu_on_a_turning_cabin_measures_rate_and_centripetal_acceleration() -> None:
    samples = imu(measure(20, rate_rad_s=0.8), "imu_cabin")[5:]
    sensor = MACHINE.sensors["imu_cabin"]
    arm = np.array([*sensor.T_link_sensor[:2, 3], 0.0])
    expected = sensor.T_link_sensor[:3, :3].T @ (np.array([0, 0, 9.81]) - 0.8**2 * arm)
    force = np.mean([sample.specific_force_m_s2 for sample in samples], axis=0)
    rate = np.mean([sample.angular_velocity_rad_s for sample in samples], axis=0)
    assert np.abs(force - expected).max() < 4 * sensor.accel_bias_m_s2
    assert np.abs(rate - [0, 0, 0.8]).max() < 4 * sensor.gyro_bias_rad_s


def test_biases_of_imus_differ_by_seed_and_walk() -> None:
    starts = [
        imu(measure(0.2, seed=seed), "imu_base")[0].angular_velocity_rad_s for seed in range(30)
    ]
    sensor = MACHINE.sensors["imu_base"]
    expected = np.hypot(sensor.gyro_bias_rad_s, sensor.gyro_noise_rad_s)
    assert np.std(starts) == pytest.approx(
        expected, rel=0.25
    )  # 90 values: 7 % at one standard deviation
    restless = sensor.model_copy(update={"gyro_walk_rad_s": 0.01, "gyro_noise_rad_s": 0.0})
    machine = MACHINE.model_copy(update={"sensors": MACHINE.sensors | {"imu_base": restless}})
    rate = np.array(
        [s.angular_velocity_rad_s for s in imu(measure(20, machine=machine), "imu_base")]
    )
    assert np.diff(rate, axis=0).std() == pytest.approx(0.01 * np.sqrt(STEP_S), rel=0.05)


def test_fixes_are_geodetic_about_the_datum_with_the_noise_that_they_report() -> None:
    datum = (46.9, 7.4, 550.0)
    fixes = [
        o
        for _, o in measure(40, datum=datum)
        if isinstance(o, GnssFix) and o.antenna == "gnss_left"
    ]
    sensor = MACHINE.sensors["gnss_left"]
    T = WORLD.T_world_body("cabin") @ sensor.T_link_sensor
    errors = (
        np.array([enu_from_geodetic(fix.geodetic, np.array(datum)) for fix in fixes]) - T[:3, 3]
    )
    assert len(fixes) == 800 - 1  # 20 Hz; the last one is still on its way
    assert np.allclose(errors.std(axis=0), np.sqrt(np.diag(fixes[0].covariance_enu_m2)), rtol=0.1)
    assert np.abs(errors.mean(axis=0)).max() < 4 * sensor.vertical_noise_m / np.sqrt(len(fixes))
    assert all(fix.is_rtk_fixed for fix in fixes)


def test_both_antennas_tell_the_heading() -> None:
    fixes = [o for _, o in measure(1.0, rate_rad_s=0.8) if isinstance(o, GnssFix)]
    datum = np.array(SensorSettings().datum)
    by_stamp: dict[float, dict[str, np.ndarray]] = {}
    for fix in fixes:
        by_stamp.setdefault(fix.stamp_s, {})[fix.antenna] = enu_from_geodetic(fix.geodetic, datum)
    for stamp_s, pair in by_stamp.items():
        across = pair["gnss_left"] - pair["gnss_right"]
        heading = np.arctan2(across[1], across[0]) - np.pi / 2
        # 8 mm over 1.9 m: 6 mrad; four of them.
        assert np.angle(np.exp(1j * (heading - 0.8 * stamp_s))) == pytest.approx(0, abs=0.025)


def test_observations_arrive_after_their_latency_and_never_before() -> None:
    samples = measure(2.0, lidars=True)
    for arrival_s, observation in samples:
        name = getattr(observation, "frame", None) or getattr(observation, "antenna", "encoders")
        latency_s = MACHINE.sensors[name].latency_s
        assert (
            observation.stamp_s + latency_s - 1e-9
            <= arrival_s
            < observation.stamp_s + latency_s + STEP_S
        )


def test_rates_are_those_of_the_description() -> None:
    samples = [o for _, o in measure(10.0)]
    assert len([o for o in samples if isinstance(o, JointSample)]) == 1000
    for sensor in MACHINE.sensors.values():
        stamps = [
            o.stamp_s
            for o in samples
            if getattr(o, "frame", getattr(o, "antenna", "encoders")) == sensor.name
        ]
        if stamps:
            assert np.allclose(np.diff(stamps), 1 / sensor.rate_hz)


def test_encoders_measure_all_joints_with_their_noise() -> None:
    samples = [o for _, o in measure(20.0, rate_rad_s=0.5) if isinstance(o, JointSample)]
    sensor = MACHINE.sensors["encoders"]
    assert samples[0].names == MACHINE.joint_names
    stamps = np.array([sample.stamp_s for sample in samples])
    turned = np.array([sample.of("J_TURN")[0] for sample in samples])
    assert (turned - 0.5 * stamps).std() == pytest.approx(sensor.angle_noise_rad, rel=0.08)
    assert turned.max() > 9  # a continuous joint is not wrapped
    lengths = np.array([sample.of("J_TELE")[0] for sample in samples])
    assert lengths.std() == pytest.approx(sensor.length_noise_m, rel=0.08)
    assert np.mean([sample.of("J_TURN")[1] for sample in samples]) == pytest.approx(0.5, abs=1e-3)


def test_a_sensor_that_dropped_out_is_silent_for_its_span_and_changes_no_other() -> None:
    whole = measure(2.0, lidars=True)
    dropouts = [
        {"sensor": "gnss_left", "from_s": 0.5, "to_s": 1.0},
        {"sensor": "lidar_vertical", "from_s": 0, "to_s": 9},
    ]
    holed = measure(2.0, lidars=True, dropouts=dropouts)
    left = [o.stamp_s for _, o in holed if isinstance(o, GnssFix) and o.antenna == "gnss_left"]
    assert not [stamp for stamp in left if 0.5 <= stamp < 1.0]
    assert len(left) == 39 - 10
    assert {o.frame for _, o in holed if isinstance(o, LidarScan)} == {"lidar_horizontal"}
    others = [[o for _, o in run if isinstance(o, ImuSample)] for run in (whole, holed)]
    assert all(
        np.array_equal(a.specific_force_m_s2, b.specific_force_m_s2)
        for a, b in zip(*others, strict=True)
    )


def test_refuses_a_dropout_of_a_sensor_that_the_machine_lacks() -> None:
    with pytest.raises(ConfigError, match=r"no sensor 'gnss_lef'\. Did you mean 'gnss_left'"):
        measure(0.1, dropouts=[{"sensor": "gnss_lef", "from_s": 0, "to_s": 1}])
    with pytest.raises(ValueError, match="must be later than from_s"):
        SensorSettings.model_validate(
            {"dropouts": [{"sensor": "gnss_left", "from_s": 2, "to_s": 1}]}
        )


def test_one_seed_gives_one_stream() -> None:
    first, again, other = (measure(0.5, lidars=True, seed=seed) for seed in (1, 1, 2))
    scans = [[o for _, o in run if isinstance(o, LidarScan)] for run in (first, again, other)]
    assert all(
        np.array_equal(a.points_lidar, b.points_lidar) for a, b in zip(*scans[:2], strict=True)
    )
    assert scans[0][0].points_lidar.shape != scans[2][0].points_lidar.shape or not np.allclose(
        scans[0][0].points_lidar, scans[2][0].points_lidar
    )


def test_lidars_measure_whole_revolutions_while_they_are_on() -> None:
    suite = SensorSuite(
        MACHINE, FLAT, SensorSettings(azimuth_stride=10), WORLD.model, np.random.default_rng(0)
    )
    scans: list[tuple[float, LidarScan]] = []
    data = mujoco.MjData(WORLD.model)
    for k in range(1, 201):
        suite.lidars_on = 0.25 < k * STEP_S < 1.0
        scans += [
            (k * STEP_S, o)
            for o in suite.step(k * STEP_S, WORLD.model, data)
            if isinstance(o, LidarScan)
        ]
    stamps = [scan.stamp_s for _, scan in scans if scan.frame == "lidar_vertical"]
    assert stamps == pytest.approx([0.4, 0.5, 0.6, 0.7, 0.8, 0.9])
    for _, scan in scans:
        assert (np.diff(scan.point_stamps_s) >= 0).all()
        assert scan.point_stamps_s.min() >= scan.stamp_s - 0.1 - 1e-9
        assert scan.point_stamps_s.max() <= scan.stamp_s
