"""A line that is timed anew: the same postures, a constant speed, soft ends."""

import numpy as np
import pytest

from executive.leaf.steady_line import steady_line
from executive.messages.trajectory import JointTrajectory

LEVER_M = 6.0  # of the only joint, so that 1 rad is 6 m of way


def line(way_m, lasts_s=1.5):
    """Return a motion of one joint over a way that starts and ends at rest, and its ways."""
    times = np.linspace(0.0, lasts_s, 60)
    passed_m = way_m * (times / lasts_s) ** 2 * (3 - 2 * times / lasts_s)
    position = 0.3 - passed_m[:, None] / LEVER_M
    velocity = np.gradient(position, times, axis=0)
    return JointTrajectory(("boom",), times, position, velocity), passed_m


@pytest.mark.parametrize(
    ("way_m", "speed_m_s", "ramp_s"), [(0.26, 0.05, 0.4), (0.06, 0.05, 0.4), (1.0, 0.3, 1.0)]
)
def test_the_speed_is_constant_between_soft_ends(way_m, speed_m_s, ramp_s):
    trajectory, passed_m = line(way_m)
    slow = steady_line(trajectory, passed_m, speed_m_s, ramp_s)
    assert slow.duration_s == pytest.approx(way_m / speed_m_s + ramp_s)
    np.testing.assert_array_equal(slow.position[0], trajectory.position[0])
    np.testing.assert_array_equal(slow.position[-1], trajectory.position[-1])
    speeds = -LEVER_M * slow.velocity[:, 0]
    middle = (slow.times_s > ramp_s) & (slow.times_s < slow.duration_s - ramp_s)
    np.testing.assert_allclose(speeds[middle], speed_m_s, rtol=1e-2)
    assert speeds[0] == speeds[-1] == 0.0
    steps = np.diff(-LEVER_M * slow.position[:, 0]) / np.diff(slow.times_s)
    # 3u² − 2u³ rises by 1.5 in each unit of u at most.
    assert np.abs(np.diff(steps)).max() / 0.02 < 1.5 * speed_m_s / ramp_s * 1.05


def test_a_line_that_is_shorter_than_both_ramps_is_slower():
    trajectory, passed_m = line(0.01, 0.3)
    slow = steady_line(trajectory, passed_m, 0.05, 0.4)
    assert slow.duration_s == pytest.approx(0.8)
    assert -LEVER_M * slow.velocity.min() == pytest.approx(0.01 / 0.4, rel=1e-2)
    assert slow.position[-1] == trajectory.position[-1]


def test_joints_that_move_while_the_tool_stands_still_are_no_faster_than_before():
    """An arm with more joints than the tool needs may change its posture on the spot."""
    trajectory, passed_m = line(0.06)
    times = np.linspace(0.0, 3.0, 120)
    turned = 0.5 * (times / 3.0) ** 2 * (3 - 2 * times / 3.0)  # ends after the line: 0.25 rad/s
    boom = np.concatenate([trajectory.position[:, 0], np.full(60, trajectory.position[-1, 0])])
    position = np.column_stack([boom, turned])
    both = JointTrajectory(("boom", "roll"), times, position, np.gradient(position, times, axis=0))
    slow = steady_line(both, np.concatenate([passed_m, np.full(60, passed_m[-1])]), 0.05, 0.4)
    assert np.abs(slow.velocity[:, 1]).max() <= np.abs(both.velocity[:, 1]).max() * 1.01
    np.testing.assert_array_equal(slow.position[-1], position[-1])


def test_a_motion_that_goes_nowhere_stays_as_it_is():
    trajectory, _ = line(0.0)
    assert steady_line(trajectory, np.zeros(60), 0.05, 0.4) is trajectory
