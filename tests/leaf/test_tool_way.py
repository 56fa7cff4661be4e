"""The way of the tool, and motions that are slow at their end."""

import numpy as np
import pytest

from executive.arrays import Float
from executive.leaf.tool_way import slow_at_the_end, tool_way
from executive.machine.machine import load_machine
from executive.messages.trajectory import JointTrajectory


def down(lasts_s: float) -> tuple[JointTrajectory, Float]:
    """Return a motion of the boom that lowers the tool by more than a metre, and its way."""
    machine = load_machine("m545")
    stamps = np.linspace(0.0, lasts_s, 101)
    u = stamps / lasts_s
    first = np.array([machine.postures["carry"][name] for name in machine.arm_names])
    position = np.tile(first, (len(stamps), 1))
    position[:, machine.arm_names.index("J_BOOM")] -= 0.4 * (3 * u**2 - 2 * u**3)
    velocity = np.gradient(position, stamps, axis=0)
    motion = JointTrajectory(machine.arm_names, stamps, position, velocity)
    return motion, tool_way(machine, motion)


def speeds(motion: JointTrajectory) -> tuple[Float, Float]:
    """Return the speed of the tool between samples, and the way that is left there."""
    passed = tool_way(load_machine("m545"), motion)
    return np.diff(passed) / np.diff(motion.times_s), passed[-1] - passed[1:]


def test_the_last_part_is_slow_and_the_first_is_not() -> None:
    motion, passed_m = down(2.0)
    assert passed_m[0] == 0
    assert passed_m[-1] > 1.0
    slow = slow_at_the_end(motion, passed_m, 0.4, 0.15, 0.5)
    speed, left_m = speeds(slow)
    assert speed[left_m < 0.4].max() == pytest.approx(0.15, rel=0.05)
    allowed = np.sqrt(0.15**2 + 2 * 0.5 * np.maximum(left_m - 0.4, 0.0))
    assert (speed < 1.05 * allowed + 0.02).all()
    before, _ = speeds(motion)
    assert speed.max() > 0.8 * before.max()
    np.testing.assert_allclose(slow.position[[0, -1]], motion.position[[0, -1]])
    assert not slow.velocity[[0, -1]].any()


def test_a_motion_that_is_slow_enough_stays_as_it_is() -> None:
    motion, passed_m = down(20.0)
    assert slow_at_the_end(motion, passed_m, 0.4, 0.15, 0.5) is motion


def test_all_of_a_way_that_is_shorter_than_its_last_part_is_slow() -> None:
    motion, passed_m = down(2.0)
    speed, _ = speeds(slow_at_the_end(motion, passed_m, 5.0, 0.15, 0.5))
    assert speed.max() == pytest.approx(0.15, rel=0.05)
