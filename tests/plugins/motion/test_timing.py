"""Timing keeps every limit at every sample and wastes little time."""

import numpy as np
import pytest
from executive_plugins.motion.path import path_through
from executive_plugins.motion.timing import Limits, time_path

from executive.arrays import Float
from executive.messages.trajectory import JointTrajectory

LIMITS = Limits(np.array([0.8, 0.3]), np.array([0.4, 0.3]), np.array([1.2, 1.0]))


def timed(nodes: Float) -> JointTrajectory:
    is_dense = np.zeros(len(nodes) - 1, dtype=bool)
    return time_path(
        ("a", "b"), path_through(nodes, is_dense, LIMITS.velocity, LIMITS.acceleration), LIMITS
    )


def random_nodes(seed: int) -> Float:
    return np.cumsum(np.random.default_rng(seed).normal(0.0, [0.8, 0.3], (6, 2)), axis=0)


@pytest.mark.parametrize("seed", range(20))
def test_keeps_velocity_and_acceleration_limits_by_finite_differences(seed: int) -> None:
    trajectory = timed(random_nodes(seed))
    times = np.arange(0.0, trajectory.duration_s, 0.002)
    q = np.array([trajectory.at(t)[0] for t in times])
    velocity = np.diff(q, axis=0) / 0.002
    acceleration = np.diff(velocity, axis=0) / 0.002
    assert (np.abs(velocity) <= LIMITS.velocity * 1.001).all()
    assert (
        np.abs(acceleration) <= LIMITS.acceleration * 1.01
    ).all()  # differences across a step of the jerk


@pytest.mark.parametrize("seed", range(5))
def test_starts_and_ends_at_rest_on_the_outer_nodes(seed: int) -> None:
    nodes = random_nodes(seed)
    trajectory = timed(nodes)
    np.testing.assert_allclose(trajectory.position[[0, -1]], nodes[[0, -1]], atol=1e-6)
    np.testing.assert_array_equal(trajectory.velocity[[0, -1]], 0.0)


def test_velocities_are_the_slopes_of_the_positions() -> None:
    trajectory = timed(random_nodes(3))
    slope = np.gradient(trajectory.position, trajectory.times_s, axis=0)
    np.testing.assert_allclose(
        slope[2:-2], trajectory.velocity[2:-2], atol=0.01
    )  # second order of a 30 ms step


def test_a_single_turn_takes_hardly_longer_than_the_limits_allow() -> None:
    trajectory = timed(np.array([[0.0, 0.0], [np.pi / 2, 0.0]]))
    fastest_s = np.pi / 2 / 0.8 + 0.8 / 0.4  # a trapezoid of velocity
    assert fastest_s <= trajectory.duration_s < 1.1 * fastest_s


def test_samples_come_at_twenty_to_fifty_hertz() -> None:
    step_s = np.diff(timed(random_nodes(1)).times_s)
    assert step_s.min() >= 0.02
    assert step_s.max() <= 0.05


def test_a_path_without_length_takes_no_time_to_speak_of() -> None:
    assert timed(np.zeros((2, 2))).duration_s < 0.1
