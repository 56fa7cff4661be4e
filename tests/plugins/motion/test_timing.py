"""Timing keeps every limit at all times, jerk among them, and wastes little time."""

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
def test_keeps_all_limits_by_finite_differences(seed: int) -> None:
    trajectory = timed(random_nodes(seed))
    times = np.arange(0.0, trajectory.duration_s, 0.002)
    q = np.array([trajectory.at(t)[0] for t in times])
    for order, limit in enumerate((LIMITS.velocity, LIMITS.acceleration, LIMITS.jerk), start=1):
        change = np.abs(np.diff(q, order, axis=0)) / 0.002**order
        assert (change <= limit * (1 + 1e-5)).all()  # rounding of third differences


def test_leaves_the_path_by_a_few_milliradians_at_most() -> None:
    nodes = random_nodes(4)
    path = path_through(nodes, np.zeros(5, dtype=bool), LIMITS.velocity, LIMITS.acceleration)
    on_path = path.position(np.linspace(0.0, path.length, 4000))
    longest_s = 2 * (LIMITS.acceleration / LIMITS.jerk).max()
    most = (longest_s**2 / 24 + 0.03**2 / 6) * np.linalg.norm(LIMITS.acceleration)
    for q in timed(nodes).position:
        assert np.linalg.norm(on_path - q, axis=1).min() < most


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
    a, j = 0.4, 1.2
    fastest_s = 2 * np.sqrt((a / (2 * j)) ** 2 + np.pi / 2 / a) + a / j  # seven segments, no cruise
    assert fastest_s <= trajectory.duration_s < 1.1 * fastest_s


def test_samples_come_at_twenty_to_fifty_hertz() -> None:
    step_s = np.diff(timed(random_nodes(1)).times_s)
    assert step_s.min() >= 0.02
    assert step_s.max() <= 0.05


def test_a_path_without_length_takes_no_time_to_speak_of() -> None:
    assert timed(np.zeros((2, 2))).duration_s < 0.1
