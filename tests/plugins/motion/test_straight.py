"""A straight line is timed as fast as its limits allow, and keeps them at all times."""

import numpy as np
import pytest
from executive_plugins.motion.straight import time_line
from executive_plugins.motion.timing import Limits

LIMITS = Limits(np.array([0.8, 0.3]), np.array([0.4, 0.3]), np.array([1.2, 1.0]))
NAMES = ("a", "b")


@pytest.mark.parametrize("seed", range(20))
def test_keeps_all_limits_and_reaches_one_of_them(seed: int) -> None:
    length = 10.0 ** np.random.default_rng(seed).uniform(-4, 1)
    goal = np.random.default_rng(seed + 100).normal(0.0, length, 2)
    trajectory = time_line(NAMES, np.zeros(2), goal, LIMITS)
    step_s = min(0.002, trajectory.duration_s / 200)
    q = np.array([trajectory.at(t)[0] for t in np.arange(0.0, trajectory.duration_s, step_s)])
    shares = [
        np.abs(np.diff(q, order, axis=0)).max(axis=0) / step_s**order / limit
        for order, limit in enumerate((LIMITS.velocity, LIMITS.acceleration, LIMITS.jerk), start=1)
    ]
    assert np.max(shares) == pytest.approx(1.0, abs=1e-3)


def test_takes_the_time_of_seven_phases() -> None:
    a, j = 0.4, 1.2
    fastest_s = 2 * np.sqrt((a / (2 * j)) ** 2 + np.pi / 2 / a) + a / j  # no phase of even speed
    goal = np.array([np.pi / 2, 0.0])
    assert time_line(NAMES, np.zeros(2), goal, LIMITS).duration_s == pytest.approx(fastest_s)


def test_stays_on_the_line_between_rest_and_rest() -> None:
    start, goal = np.array([0.2, -0.1]), np.array([-1.1, 0.4])
    trajectory = time_line(NAMES, start, goal, LIMITS)
    share = (trajectory.position - start) / (goal - start)
    np.testing.assert_allclose(share[:, 0], share[:, 1], atol=1e-12)
    np.testing.assert_array_equal(trajectory.position[[0, -1]], [start, goal])
    np.testing.assert_array_equal(trajectory.velocity[[0, -1]], 0.0)
    assert (np.diff(share[:, 0]) > 0).all()
    assert np.diff(trajectory.times_s).max() <= 0.03 + 1e-9


def test_a_line_without_length_takes_one_period_at_rest() -> None:
    trajectory = time_line(NAMES, np.ones(2), np.ones(2), LIMITS)
    assert trajectory.duration_s == 0.03
    np.testing.assert_array_equal(trajectory.position, np.ones((2, 2)))
    np.testing.assert_array_equal(trajectory.velocity, np.zeros((2, 2)))
