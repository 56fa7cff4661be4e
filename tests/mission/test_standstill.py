"""A machine that was told to stop is awaited until its joints stand and its chassis has braked."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.clock import SimulatedClock
from executive.leaf.rest import stop_limit_s
from executive.machine.machine import load_machine
from executive.messages.joints import JointSample
from executive.mission.braking import MachineMovesError
from executive.mission.standstill import Standstill, brake_s

MACHINE = load_machine("m545")
NAMES = MACHINE.joint_names
TICK_S = 0.05
LIMIT_S = stop_limit_s(MACHINE, NAMES)


def sample(stamp_s, speed, position=0.0):
    n = len(NAMES)
    velocity = np.zeros(n)
    velocity[0] = speed
    return JointSample(stamp_s, NAMES, np.full(n, position), velocity, np.zeros(n))


class Robot:
    """A machine that comes to rest after some time."""

    def __init__(self, rests_s):
        self.rests_s, self.reads = rests_s, 0

    def read(self, now_s):
        self.reads += 1
        speed = 0.0 if now_s >= self.rests_s - 1e-9 else 0.2
        return ["another observation", sample(now_s, speed, position=now_s), "and another"]


def test_without_a_sample_there_is_nothing_to_wait_for():
    assert Standstill(SimulatedClock(), MACHINE).reached(None)


def test_joints_that_stand_are_at_rest_and_those_that_move_are_not():
    standstill = Standstill(SimulatedClock(), MACHINE)
    assert not standstill.reached(sample(0.0, 0.2))
    assert not standstill.reached(sample(0.0, -0.2))
    assert standstill.reached(sample(0.0, 0.0))


def test_a_chassis_may_still_roll_after_all_joints_stand():
    clock = SimulatedClock()
    standstill = Standstill(clock, MACHINE, brake_s=0.5)
    for tick in range(10):
        assert not standstill.reached(sample(tick * TICK_S, 0.0))
        clock.advance(TICK_S)
    assert standstill.reached(sample(0.5, 0.0))


def test_a_machine_that_moves_for_too_long_is_told():
    clock = SimulatedClock()
    standstill = Standstill(clock, MACHINE)
    while clock.machine_s() < LIMIT_S:
        now_s = clock.machine_s()
        assert not standstill.reached(sample(now_s, 0.2, position=now_s))
        clock.advance(TICK_S)
    with pytest.raises(MachineMovesError, match=f"still moves {LIMIT_S:.1f} s after the stop"):
        standstill.reached(sample(LIMIT_S, 0.2, position=LIMIT_S))


def test_the_time_counts_from_when_it_began_to_look():
    clock = SimulatedClock()
    clock.advance(2 * LIMIT_S)
    assert not Standstill(clock, MACHINE, brake_s=0.5).reached(sample(2 * LIMIT_S, 0.0))
    assert not Standstill(clock, MACHINE).reached(sample(2 * LIMIT_S, 0.2))


@pytest.mark.parametrize("rests_s", [0.0, 0.5])
def test_a_robot_is_read_alone_until_it_is_at_rest(rests_s):
    clock, robot = SimulatedClock(), Robot(rests_s)
    moving = sample(0.0, 0.2)
    ticks = Standstill(clock, MACHINE).await_alone(robot, moving, TICK_S)
    assert ticks == robot.reads == max(1, round(rests_s / TICK_S))
    assert clock.machine_s() == pytest.approx(ticks * TICK_S)


def test_a_robot_that_stands_already_is_not_read():
    robot = Robot(0.0)
    assert Standstill(SimulatedClock(), MACHINE).await_alone(robot, sample(0.0, 0.0), TICK_S) == 0
    assert robot.reads == 0


def test_a_chassis_brakes_in_missions_that_drive_alone():
    driving = MACHINE.driving
    expected_s = driving.max_speed_m_s / driving.max_acceleration_m_s2
    assert brake_s(MACHINE, {"driving": object()}) == pytest.approx(expected_s)
    assert brake_s(MACHINE, {"motion": object()}) == 0.0
    assert brake_s(SimpleNamespace(driving=None), {"driving": object()}) == 0.0
