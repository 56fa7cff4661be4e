"""What every estimator must do, whatever its method."""

import numpy as np
import pytest

from executive.geometry.pose import inverse
from executive.interfaces.estimation import Estimator
from executive.machine.machine import Machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement
from executive.testing.exercises.estimation import DATUM, T_map_cabin_at_rest, feed_rest
from executive.testing.pytest_plugin import Insist

CAPABILITY = "estimation"


def test_it_says_that_it_knows_nothing_yet(plugin: Estimator) -> None:
    assert not plugin.state().is_ready


def test_it_finds_a_machine_at_rest(plugin: Estimator, machine: Machine, insist: Insist) -> None:
    feed_rest(plugin, machine)
    state = plugin.state()
    insist(state.is_ready, f"its status is {state.status} after six seconds at rest")
    assert state.stamp_s == pytest.approx(5.99)
    np.testing.assert_allclose(state.T_map_cabin, T_map_cabin_at_rest(machine), atol=5e-3)
    np.testing.assert_allclose(state.T_map_base, np.eye(4), atol=5e-3)
    np.testing.assert_allclose(state.v_map_cabin, np.zeros(3), atol=5e-3)
    assert (np.linalg.eigvalsh(state.covariance) > 0).all()


def test_cabin_and_chassis_agree_with_the_turn_joint(
    plugin: Estimator, machine: Machine, insist: Insist
) -> None:
    feed_rest(plugin, machine)
    state = plugin.state()
    insist(state.is_ready, f"its status is {state.status} after six seconds at rest")
    np.testing.assert_allclose(
        inverse(state.T_map_base) @ state.T_map_cabin, T_map_cabin_at_rest(machine), atol=1e-9
    )


def test_a_sample_out_of_order_or_twice_does_no_harm(plugin: Estimator, machine: Machine) -> None:
    feed_rest(plugin, machine)
    before = plugin.state()
    for stamp_s in (5.99, 3.0, float("nan")):
        plugin.add_imu(ImuSample(stamp_s, "imu_cabin", np.ones(3), np.ones(3)))
        plugin.add_gnss(GnssFix(stamp_s - 0.04, "gnss_left", DATUM + 1.0, np.eye(3) * 1e-4, True))
    after = plugin.state()
    assert after.stamp_s == before.stamp_s
    np.testing.assert_allclose(after.T_map_cabin, before.T_map_cabin, atol=1e-3)


def test_it_takes_lidar_increments(plugin: Estimator, machine: Machine) -> None:
    feed_rest(plugin, machine)
    plugin.add_odometry(LidarIncrement(5.8, 5.9, "lidar_horizontal", np.eye(4), np.eye(6) * 1e-4))
    np.testing.assert_allclose(plugin.state().T_map_base, np.eye(4), atol=5e-3)
