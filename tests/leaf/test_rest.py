"""Joints are at rest if they are slow, or shake on the spot for a second."""

import numpy as np
import pytest

from executive.leaf.rest import Rest, stop_limit_s
from executive.machine.machine import load_machine
from executive.messages.command import START_TOLERANCE

FAST, SLOW = np.array([0.0, 0.02]), np.array([0.009, -0.009])


def test_slow_joints_are_at_rest_at_once():
    assert Rest().add(0.0, np.zeros(2), SLOW)
    assert not Rest().add(0.0, np.zeros(2), FAST)
    assert not Rest().add(0.0, np.zeros(2), -FAST)
    assert not Rest().add(0.0, np.zeros(2), np.full(2, 0.01))


def shaking(rest, amplitude, seconds, start_s=0.0):
    """Return the answers at ten samples a second of joints that shake to and fro."""
    steps = range(round(seconds * 10) + 1)
    return [rest.add(start_s + i / 10, np.array([0.0, (i % 2) * amplitude]), FAST) for i in steps]


def test_joints_that_shake_on_the_spot_are_at_rest_after_a_second():
    answers = shaking(Rest(), 0.39 * START_TOLERANCE, 1.5)
    assert answers == [False] * 10 + [True] * 6


def test_joints_that_stray_farther_are_not_at_rest():
    assert not any(shaking(Rest(), 0.41 * START_TOLERANCE, 3.0))


def test_what_was_over_a_second_ago_does_not_count():
    rest = Rest()
    rest.add(0.0, np.array([5.0, 5.0]), FAST)
    assert shaking(rest, 0.0, 1.0, start_s=0.1) == [False] * 10 + [True]
    assert rest.strayed() == pytest.approx([0.0, 0.0])


def test_strayed_is_the_range_of_each_joint():
    rest = Rest()
    for i, position in enumerate([(0.0, 1.0), (-0.2, 1.1), (0.1, 0.9)]):
        rest.add(i / 10, np.array(position), FAST)
    assert rest.strayed() == pytest.approx([0.3, 0.2])


def test_a_stop_may_take_twice_the_longest_of_its_joints_and_the_window():
    machine = load_machine("m545")
    times_s = machine.max_velocity / machine.max_acceleration
    assert stop_limit_s(machine, machine.arm_names) == pytest.approx(2 * times_s.max() + 1.0)
    name = machine.arm_names[int(times_s.argmin())]
    assert stop_limit_s(machine, [name]) == pytest.approx(2 * times_s.min() + 1.0)
    assert stop_limit_s(machine, []) == 1.0


def test_a_stop_with_a_load_on_supports_that_yield_may_take_longer():
    machine = load_machine("m545")
    stance = machine.stance.model_copy(update={"support_n_m": 2e6})
    on_legs = machine.model_copy(update={"stance": stance})
    welded_s = stop_limit_s(machine, machine.arm_names)
    assert stop_limit_s(on_legs, machine.arm_names) == pytest.approx(welded_s + 2.5)
