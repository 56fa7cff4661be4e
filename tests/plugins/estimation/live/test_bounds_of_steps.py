"""Where a compiled step stops: ranges of sensors, gaps, extrapolated angles, old samples."""

import numpy as np
import pytest
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState, propagate_through
from executive_plugins.estimation.live.kernels import is_beyond_range
from executive_plugins.estimation.live.packing import packed
from executive_plugins.estimation.live.propagator import GAP, LivePropagator
from executive_plugins.estimation.start.chassis import TurnJoint

from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import exp_so3
from executive.messages.joints import JointSample

NOISE = InertialNoise(2e-3, 3e-2, 4e-4, 5e-3, 0.1, 9.81, 0.01)
T_IMU_CABIN = pose(exp_so3(np.array([0.4, -0.2, 1.1])), np.array([0.3, -0.8, 0.5]))
UP = np.array([0.0, 0.0, 9.81])


@pytest.fixture
def turn(machine) -> TurnJoint:
    turn = TurnJoint(machine)
    names = machine.joint_names
    position, velocity = np.zeros(len(names)), np.zeros(len(names))
    index = names.index(machine.turn_joint)
    position[index], velocity[index] = 0.7, -0.3
    turn.update(JointSample(1.0, names, position, velocity, np.zeros(len(names))))
    return turn


@pytest.fixture
def propagator(turn) -> LivePropagator:
    return LivePropagator(T_IMU_CABIN, turn, NOISE, gap_s=0.5)


def state(stamp_s: float, x_m: float = 0.0) -> InertialState:
    """Return a body that turns and moves; no two of its numbers are alike."""
    sample = Inertial(stamp_s, np.array([0.2, -0.3, 0.4]), UP)
    return InertialState(
        sample,
        exp_so3(np.array([0.3, 0.2, -0.9])),
        np.array([x_m, 2.0, 3.0]),
        np.array([0.5, -0.7, 0.2]),
        np.array([0.01, -0.02, 0.03]),
        np.array([0.1, 0.2, -0.3]),
    )


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_each_axis_has_the_range_of_the_sensor(axis: int, sign: float) -> None:
    """2000 degrees a second are 34.9 rad/s, 16 g are 157 m/s²."""
    along = sign * np.eye(3)[axis]
    assert not is_beyond_range(35.0 * along, 160.0 * along)
    assert is_beyond_range(35.1 * along, np.zeros(3))
    assert is_beyond_range(np.zeros(3), 160.1 * along)


@pytest.mark.parametrize(("dt_s", "is_taken"), [(0.0, True), (0.5, True), (0.51, False)])
def test_a_gap_is_bridged_up_to_its_bound(propagator, dt_s: float, is_taken: bool) -> None:
    propagator.take(packed(state(1.0), np.eye(15)))
    said = propagator.step(1.0 + dt_s, np.zeros(3), UP)
    assert said == (0 if is_taken else GAP)
    assert propagator.stamp_s == (1.0 + dt_s if is_taken else 1.0)
    assert propagator.samples == is_taken


def test_the_turn_joint_is_extrapolated_by_a_tenth_of_a_second(propagator, turn) -> None:
    """It turns by -0.3 rad/s, and its newest sample is of 1 s."""
    for stamp_s, ahead_s in ((0.8, -0.1), (0.95, -0.05), (1.08, 0.08), (1.3, 0.1)):
        propagator.take(packed(state(stamp_s), np.eye(15)), is_alone=True)
        said = propagator.state("")
        T_cabin_base = pose(exp_so3(-(0.7 - 0.3 * ahead_s) * turn.axis)) @ turn.T_joint_base
        found = inverse(said.T_map_cabin) @ said.T_map_base
        np.testing.assert_allclose(found, T_cabin_base, atol=1e-12)


def test_samples_that_are_forgotten_move_no_estimate(propagator) -> None:
    propagator.take(packed(state(1.0), np.eye(15)))
    for k in range(1, 6):
        propagator.step(1.0 + 0.01 * k, np.zeros(3), UP)
    propagator.forget_samples()
    late = [Inertial(1.0 + 0.01 * k, np.array([0.1, 0.2, 0.3]), UP) for k in (6, 7)]
    for sample in late:
        propagator.step(sample.stamp_s, sample.rate, sample.force)
    propagator.take(packed(state(1.02), np.eye(15)))
    end = propagate_through(state(1.02), late, 9.81)
    expected = pose(end.R_map_imu, end.p_map_imu) @ T_IMU_CABIN
    np.testing.assert_allclose(propagator.state("").T_map_cabin, expected, atol=1e-12)
    assert propagator.stamp_s == 1.07


def test_an_estimate_of_another_start_leaves_the_odometry_where_it_is_in_the_map(
    propagator,
) -> None:
    propagator.take(packed(state(1.0), np.eye(15)))
    propagator.take(packed(state(1.0, x_m=4.0), np.eye(15)))  # a correction by 4 m
    said = propagator.state("")
    T_odom_map = said.T_odom_base @ inverse(said.T_map_base)
    np.testing.assert_allclose(T_odom_map, pose(t=np.array([-4.0, 0.0, 0.0])), atol=1e-12)
    propagator.take(packed(state(1.0, x_m=9.0), np.eye(15)), is_alone=True)
    said = propagator.state("")
    T_odom_map = said.T_odom_base @ inverse(said.T_map_base)
    np.testing.assert_allclose(T_odom_map, pose(t=np.array([-4.0, 0.0, 0.0])), atol=1e-12)
    propagator.take(packed(state(1.0, x_m=10.0), np.eye(15)))
    said = propagator.state("")
    T_odom_map = said.T_odom_base @ inverse(said.T_map_base)
    np.testing.assert_allclose(T_odom_map, pose(t=np.array([-5.0, 0.0, 0.0])), atol=1e-12)


def test_an_anchor_changes_the_covariance_alone(propagator) -> None:
    propagator.take(packed(state(1.0), np.eye(15)))
    before = propagator.state("")
    propagator.anchor(packed(state(1.0, x_m=4.0), 4.0 * np.eye(15)))
    after = propagator.state("")
    np.testing.assert_array_equal(after.T_map_cabin, before.T_map_cabin)
    np.testing.assert_allclose(after.covariance, 4.0 * before.covariance, rtol=1e-12)
