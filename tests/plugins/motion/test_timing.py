"""Timing keeps every limit at all times, jerk among them, and wastes little time."""

from dataclasses import replace

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


# A short way up of a machine of seven joints, as inverse kinematics gave it: the end of the line
# and the goal that it was meant for differ by 25 µrad.
NODES = [
    [-0.1815442, 0.7605517, -0.0499404, 0.7666697, -0.8502788, 0.0011649, 0.4030692],
    [-0.1815355, 0.7689612, -0.0484313, 0.7640564, -0.8601974, 0.0011649, 0.4030604],
    [-0.1815267, 0.7772957, -0.0467470, 0.7615313, -0.8702162, 0.0011649, 0.4030517],
    [-0.1815180, 0.7855539, -0.0448877, 0.7590959, -0.8803338, 0.0011649, 0.4030429],
    [-0.1815425, 0.7855575, -0.0448960, 0.7590920, -0.8803291, 0.0011649, 0.4030674],
]
ARM = Limits(
    np.array([0.45, 0.225, 0.36, 0.36, 0.54, 0.54, 0.63]),
    np.array([0.225, 0.18, 0.27, 0.27, 0.45, 0.36, 0.45]),
    np.array([1.2, 1.0, 1.5, 2.0, 3.0, 2.0, 4.0]),
)


@pytest.mark.parametrize("dense", [(1, 1, 0, 0), (0, 1, 1, 1), (0, 0, 0, 0)])
@pytest.mark.parametrize("apart", [1.0, 6.0, 40.0])
def test_nodes_that_nearly_coincide_do_not_stop_the_motion(
    dense: tuple[int, ...], apart: float
) -> None:
    nodes = np.array(NODES)
    nodes[4] += (apart - 1.0) * (nodes[4] - nodes[3])
    path = path_through(nodes, np.array(dense, dtype=bool), ARM.velocity, ARM.acceleration)
    trajectory = time_path(tuple("abcdefg"), path, ARM)
    np.testing.assert_allclose(trajectory.position[[0, -1]], nodes[[0, -1]], atol=1e-9)
    assert trajectory.duration_s < 9.0  # 1.2 s without the last node


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


def test_a_motion_that_is_averaged_takes_that_time_longer_and_accelerates_less() -> None:
    nodes = np.array([[0.0, 0.0], [0.3, 0.2]])
    path = path_through(nodes, np.zeros(1, dtype=bool), LIMITS.velocity, LIMITS.acceleration)
    short, long = (
        time_path(("a", "b"), path, replace(LIMITS, least_average_s=average_s))
        for average_s in (0.0, 1.5)
    )
    assert 0.5 < long.duration_s - short.duration_s < 1.5
    strongest = [np.abs(np.diff(one.velocity, axis=0)).max() for one in (short, long)]
    assert strongest[1] < strongest[0]
    np.testing.assert_allclose(long.position[[0, -1]], nodes, atol=1e-9)


def test_a_path_without_length_takes_no_time_to_speak_of() -> None:
    assert timed(np.zeros((2, 2))).duration_s < 0.1
