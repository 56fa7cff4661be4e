"""Inertial sensors, antennas, histories and outages on one body that is moved by hand."""

import mujoco
import numpy as np
import pytest
from executive_plugins.robot.mujoco.sensors.dropout import Dropout, check_dropouts, is_silent
from executive_plugins.robot.mujoco.sensors.gnss import Antenna
from executive_plugins.robot.mujoco.sensors.imu import MountedImu
from executive_plugins.robot.mujoco.sensors.pose_history import PoseHistory

from executive.errors import ConfigError
from executive.geometry.geodesy import enu_from_geodetic
from executive.geometry.rotation import exp_so3, quaternion_wxyz
from executive.machine.sensor import Gnss, Imu

WORLD = """
<mujoco><worldbody><body name="other"/><body name="link"><freejoint/>
<inertial pos="0.3 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody></mujoco>
"""
DATUM = np.array([47.4, 8.5, 440.0])
MOUNT = {"link": "link", "xyz_m": (0.5, -1.0, 2.0), "rpy_rad": (0.1, -0.2, 0.3)}
ARM = np.array(MOUNT["xyz_m"])


class Body:
    """A free body and its world."""

    def __init__(self) -> None:
        self.model = mujoco.MjModel.from_xml_string(WORLD)
        self.data = mujoco.MjData(self.model)

    def move(self, p, R, v=(0, 0, 0), w_body=(0, 0, 0)) -> None:
        """Put it at a pose, with a velocity of its origin and an angular one in its own axes."""
        self.data.qpos[:3], self.data.qpos[3:] = p, quaternion_wxyz(R)
        self.data.qvel[:3], self.data.qvel[3:] = v, w_body
        mujoco.mj_forward(self.model, self.data)


def imu(**errors: float) -> Imu:
    none = dict.fromkeys(
        ("gyro_noise_rad_s", "gyro_bias_rad_s", "gyro_walk_rad_s",
         "accel_noise_m_s2", "accel_bias_m_s2", "accel_walk_m_s2"), 0.0)  # fmt: skip
    given = {"kind": "imu", "name": "imu", "rate_hz": 100.0, "provenance": "guess", **MOUNT}
    return Imu.model_validate({**given, **none, **errors})


def test_samples_are_the_mean_rate_and_force_at_the_mount() -> None:
    """A body that turns evenly about an axis and is thrown: analytic differences of its motion."""
    body, sensor = Body(), imu()
    mounted = MountedImu(sensor, body.model, np.random.default_rng(0))
    w, v0, gravity = np.array([0.3, -0.4, 0.8]), np.array([1.0, 2.0, 3.0]), np.array([0, 0, -9.81])
    a = np.array([0.5, -0.2, 0.1])

    def motion(t: float) -> tuple[np.ndarray, np.ndarray]:
        R = exp_so3(w * t)  # w in world and body axes alike
        return R, v0 + a * t + np.cross(w, R @ ARM)

    samples = []
    for t in (0.0, 0.02, 0.05):
        R, _ = motion(t)
        body.move(np.zeros(3), R, v0 + a * t, w)
        samples.append(mounted.sample(t, body.data))
    assert samples[0] is None
    R_link_imu = sensor.T_link_sensor[:3, :3]
    for (t0, t1), sample in zip(((0.0, 0.02), (0.02, 0.05)), samples[1:], strict=True):
        (_, before), (_, after) = motion(t0), motion(t1)
        R_imu = exp_so3(w * (t0 + t1) / 2) @ R_link_imu
        assert (sample.stamp_s, sample.frame) == (t1, "imu")
        np.testing.assert_allclose(sample.angular_velocity_rad_s, R_link_imu.T @ w, atol=1e-9)
        expected = R_imu.T @ ((after - before) / (t1 - t0) - gravity)
        np.testing.assert_allclose(sample.specific_force_m_s2, expected, atol=1e-9)


def test_errors_of_an_inertial_sensor_have_the_size_that_is_declared() -> None:
    body, dt = Body(), 0.04
    body.move(np.zeros(3), np.eye(3))
    errors = {"gyro_noise_rad_s": 0.02, "accel_noise_m_s2": 0.3}
    walks = {"gyro_walk_rad_s": 0.005, "accel_walk_m_s2": 0.07}
    biases = {"gyro_bias_rad_s": 0.1, "accel_bias_m_s2": 0.4}
    level = imu().T_link_sensor[:3, :3].T @ [0, 0, 9.81]

    def samples(count: int, seed: int, **given: float) -> tuple[np.ndarray, MountedImu]:
        mounted = MountedImu(imu(**given), body.model, np.random.default_rng(seed))
        told = [mounted.sample(k * dt, body.data) for k in range(count + 1)][1:]
        return np.array(
            [[s.angular_velocity_rad_s, s.specific_force_m_s2 - level] for s in told]
        ), mounted

    white, _ = samples(2000, 1, **errors)
    assert white.std(axis=(0, 2)) == pytest.approx([0.02, 0.3], rel=0.1)
    walked, mounted = samples(2000, 2, **walks)
    steps = np.diff(walked, axis=0).std(axis=(0, 2)) / np.sqrt(dt)
    assert steps == pytest.approx([0.005, 0.07], rel=0.1)
    np.testing.assert_allclose(walked[-1], mounted.biases, atol=1e-9)
    begun = np.array([samples(1, seed, **biases)[0][0] for seed in range(400)])
    assert begun.std(axis=(0, 2)) == pytest.approx([0.1, 0.4], rel=0.15)


def test_a_sensor_that_begins_again_takes_its_biases_back() -> None:
    body = Body()
    body.move(np.zeros(3), np.eye(3))
    first, second = (
        MountedImu(imu(gyro_bias_rad_s=0.1), body.model, np.random.default_rng(n)) for n in (1, 2)
    )
    second.sample(0.0, body.data)
    second.begin_again(first.biases)
    assert second.sample(5.0, body.data) is None
    told = second.sample(5.1, body.data)
    np.testing.assert_allclose(told.angular_velocity_rad_s, first.biases[0], atol=1e-9)


def test_an_antenna_measures_where_it_is_with_the_noise_that_it_declares() -> None:
    body = Body()
    given = {"kind": "gnss", "name": "gnss", "rate_hz": 10.0, "provenance": "guess", **MOUNT}
    given |= {"horizontal_noise_m": 0.02, "vertical_noise_m": 0.05}
    antenna = Antenna(Gnss.model_validate(given), DATUM, body.model, np.random.default_rng(0))
    R, p = exp_so3(np.array([0.2, 0.3, -1.0])), np.array([30.0, -20.0, 4.0])
    body.move(p, R)
    fixes = [antenna.sample(1.5, body.data) for _ in range(600)]
    off = np.array([enu_from_geodetic(one.geodetic, DATUM) for one in fixes]) - (p + R @ ARM)
    np.testing.assert_allclose(off.mean(axis=0), 0.0, atol=0.01)
    np.testing.assert_allclose(off.std(axis=0), [0.02, 0.02, 0.05], rtol=0.12)
    np.testing.assert_allclose(fixes[0].covariance_enu_m2, np.diag([4e-4, 4e-4, 25e-4]))
    assert (fixes[0].stamp_s, fixes[0].antenna, fixes[0].is_rtk_fixed) == (1.5, "gnss", True)


def test_a_history_interpolates_and_holds_its_ends() -> None:
    body, history = Body(), None
    history = PoseHistory(body.model, ("other", "link"), 0.1)
    assert history.oldest_s == np.inf
    for k in range(4):
        body.move([k, 0, 0], exp_so3(np.array([0, 0, 0.01 * k])))
        history.push(0.05 * k, body.data)
    assert (history.index("other"), history.index("link")) == (0, 1)
    assert history.oldest_s == pytest.approx(0.05)  # the newest at or before the span's begin
    places, turns = history.track("link", np.array([0.0, 0.05, 0.06, 0.125, 0.15, 9.0]))
    np.testing.assert_allclose(places[:, 0], [1, 1, 1.2, 2.5, 3, 3], atol=1e-9)
    np.testing.assert_allclose(turns[:, 1, 0], 0.01 * places[:, 0], atol=1e-4)
    place, turn = history.poses(0.06)
    np.testing.assert_allclose(place, [[0, 0, 0], [1.2, 0, 0]], atol=1e-9)
    assert turn.shape == (2, 3, 3)
    history.clear()
    body.move([7, 0, 0], np.eye(3))
    history.push(1.0, body.data)
    places, turns = history.track("link", np.array([0.0, 1.0, 2.0]))
    np.testing.assert_allclose(places, [[7, 0, 0]] * 3)
    np.testing.assert_allclose(turns, [np.eye(3)] * 3)


def test_a_sensor_is_silent_from_the_first_time_to_the_one_before_the_last() -> None:
    outages = (
        Dropout.model_validate({"sensor": "imu", "from_s": 1.0, "to_s": 2.0}),
        Dropout.model_validate({"sensor": "gnss", "from_s": 5.0, "to_s": 6.0}),
    )
    told = [is_silent(outages, "imu", at_s) for at_s in (0.99, 1.0, 1.99, 2.0, 5.5)]
    assert told == [False, True, True, False, False]
    check_dropouts(outages, ("imu", "gnss"))
    with pytest.raises(ConfigError, match=r"no sensor 'gnss'\. Did you mean 'gnss_left'"):
        check_dropouts(outages, ("imu", "gnss_left"))
    for to_s in (1.0, 0.5):
        with pytest.raises(ValueError, match="must be later than from_s 1"):
            Dropout.model_validate({"sensor": "imu", "from_s": 1.0, "to_s": to_s})
