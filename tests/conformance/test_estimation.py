"""What every estimator must do, whatever its method."""

from collections.abc import Iterator

import numpy as np
import pytest

from executive import registry
from executive.arrays import Float
from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import inverse, transform
from executive.interfaces.estimation import Estimator
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.odometry import LidarIncrement

DATUM = np.array([47.4084, 8.5106, 440.0])
STANDARD_GRAVITY = np.array([0.0, 0.0, 9.81])


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


@pytest.fixture(params=[plugin.name for plugin in registry.installed("estimation")])
def estimator(request: pytest.FixtureRequest, machine: Machine) -> Iterator[Estimator]:
    plugin = registry.load("estimation", request.param)
    services = {"machine": machine, "rng": np.random.default_rng(0)}
    arguments = [services[name] for name in registry.dependencies_of(plugin)]
    estimator = plugin(plugin.Settings(), *arguments)
    estimator.start()
    yield estimator
    estimator.close()


def feed_rest(estimator: Estimator, machine: Machine, duration_s: float) -> Float:
    """Feed a machine that stands about the map's origin, free of noise; return its T_map_cabin."""
    frames = Kinematics(machine).frames(machine.posture("scan"))
    position = np.append(machine.posture("scan"), 0.0)
    zeros = np.zeros(len(position))
    for k in range(round(100 * duration_s)):
        t = k / 100
        for imu in machine.sensors_of("imu"):
            estimator.add_imu(
                ImuSample(t, imu.name, np.zeros(3), frames[imu.name][:3, :3].T @ STANDARD_GRAVITY)
            )
        estimator.add_joints(JointSample(t, machine.joint_names, position, zeros, zeros))
        for antenna in machine.sensors_of("gnss") if k % 5 == 0 else ():
            geodetic = geodetic_from_enu(transform(frames[antenna.name], np.zeros(3)), DATUM)
            estimator.add_gnss(GnssFix(t, antenna.name, geodetic, np.eye(3) * 1e-4, True))
    return frames[machine.cabin_link]


def test_it_is_an_estimator(estimator: Estimator) -> None:
    assert isinstance(estimator, Estimator)


def test_it_says_that_it_knows_nothing_yet(estimator: Estimator) -> None:
    assert not estimator.state().is_ready


def test_it_finds_a_machine_at_rest(estimator: Estimator, machine: Machine) -> None:
    T_map_cabin = feed_rest(estimator, machine, 6.0)
    state = estimator.state()
    assert state.is_ready
    assert state.stamp_s == pytest.approx(5.99)
    np.testing.assert_allclose(state.T_map_cabin, T_map_cabin, atol=5e-3)
    np.testing.assert_allclose(state.T_map_base, np.eye(4), atol=5e-3)
    np.testing.assert_allclose(state.v_map_cabin, np.zeros(3), atol=5e-3)
    assert (np.linalg.eigvalsh(state.covariance) > 0).all()


def test_cabin_and_chassis_agree_with_the_turn_joint(
    estimator: Estimator, machine: Machine
) -> None:
    T_base_cabin = feed_rest(estimator, machine, 6.0)
    state = estimator.state()
    np.testing.assert_allclose(
        inverse(state.T_map_base) @ state.T_map_cabin, T_base_cabin, atol=1e-9
    )


def test_a_sample_out_of_order_or_twice_does_no_harm(
    estimator: Estimator, machine: Machine
) -> None:
    feed_rest(estimator, machine, 6.0)
    before = estimator.state()
    for stamp_s in (5.99, 3.0, float("nan")):
        estimator.add_imu(ImuSample(stamp_s, "imu_cabin", np.ones(3), np.ones(3)))
        estimator.add_gnss(
            GnssFix(stamp_s - 0.04, "gnss_left", DATUM + 1.0, np.eye(3) * 1e-4, True)
        )
    after = estimator.state()
    assert after.stamp_s == before.stamp_s
    np.testing.assert_allclose(after.T_map_cabin, before.T_map_cabin, atol=1e-3)


def test_it_takes_lidar_increments(estimator: Estimator, machine: Machine) -> None:
    feed_rest(estimator, machine, 6.0)
    estimator.add_odometry(
        LidarIncrement(5.8, 5.9, "lidar_horizontal", np.eye(4), np.eye(6) * 1e-4)
    )
    np.testing.assert_allclose(estimator.state().T_map_base, np.eye(4), atol=5e-3)
