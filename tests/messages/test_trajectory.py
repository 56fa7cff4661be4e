"""Hermite interpolation of a trajectory, against cubics, which it must reproduce."""

import numpy as np
import pytest

from executive.messages.joints import JointSample
from executive.messages.trajectory import JointTrajectory

TIMES_S = np.array([0.0, 0.4, 1.0, 1.1])


def cubic(t: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Two joints along cubics, with their derivatives."""
    t = np.asarray(t)
    position = np.stack([1 + 2 * t - 3 * t**2 + 0.5 * t**3, -(t**3)], axis=-1)
    velocity = np.stack([2 - 6 * t + 1.5 * t**2, -3 * t**2], axis=-1)
    return position, velocity


@pytest.fixture
def trajectory() -> JointTrajectory:
    return JointTrajectory(("a", "b"), TIMES_S.copy(), *cubic(TIMES_S))


def test_a_cubic_is_followed_exactly(trajectory: JointTrajectory) -> None:
    for t in np.linspace(0.001, 1.099, 57):
        position, velocity = trajectory.at(t)
        np.testing.assert_allclose(position, cubic(t)[0], atol=1e-12)
        np.testing.assert_allclose(velocity, cubic(t)[1], atol=1e-11)


def test_samples_are_met(trajectory: JointTrajectory) -> None:
    for i, t in enumerate(TIMES_S):
        np.testing.assert_allclose(trajectory.at(t)[0], trajectory.position[i], atol=1e-12)


def test_velocity_is_the_derivative_of_position() -> None:
    rng = np.random.default_rng(0)
    trajectory = JointTrajectory(
        ("a",), TIMES_S.copy(), rng.normal(size=(4, 1)), rng.normal(size=(4, 1))
    )
    h = 1e-6
    for t in (0.1, 0.39, 0.7, 1.05):
        difference = (trajectory.at(t + h)[0] - trajectory.at(t - h)[0]) / (2 * h)
        np.testing.assert_allclose(trajectory.at(t)[1], difference, atol=1e-7)


def test_the_ends_hold_and_the_goal_is_at_rest(trajectory: JointTrajectory) -> None:
    position, velocity = trajectory.at(5.0)
    np.testing.assert_array_equal(position, trajectory.position[-1])
    np.testing.assert_array_equal(velocity, np.zeros(2))
    position, velocity = trajectory.at(-1.0)
    np.testing.assert_array_equal(position, trajectory.position[0])
    np.testing.assert_array_equal(velocity, np.zeros(2))
    assert trajectory.duration_s == pytest.approx(1.1)


def test_a_single_sample_holds() -> None:
    trajectory = JointTrajectory(("a",), np.zeros(1), np.array([[2.0]]), np.zeros((1, 1)))
    for t in (0.0, 1.0):
        np.testing.assert_array_equal(trajectory.at(t)[0], [2.0])


def test_a_joint_is_found_by_its_name_and_an_unknown_one_is_named() -> None:
    sample = JointSample(0.0, ("a", "b"), [1, 2], [3, 4], [5, 6])
    assert sample.of("b") == (2.0, 4.0, 6.0)
    with pytest.raises(Exception, match="no joint 'c' in the sample; it has a, b"):
        sample.of("c")


def test_the_motion_begins_at_its_first_sample_and_rests_before_it() -> None:
    moving = JointTrajectory(("a",), [0.0, 1.0], [[0.0], [1.0]], [[0.5], [0.0]])
    np.testing.assert_allclose(moving.at(0.0), ([0.0], [0.5]))
    np.testing.assert_allclose(moving.at(-0.1), ([0.0], [0.0]))
    np.testing.assert_allclose(moving.at(1.1), ([1.0], [0.0]))
