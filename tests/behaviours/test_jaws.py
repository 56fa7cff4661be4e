"""The jaws are driven until they rest: less than 10 mrad in half a second."""

import pytest

from executive.interfaces.robot import Robot
from executive.leaf.jaws import drive_jaws
from executive.messages.command import MoveJaws


@pytest.fixture
def jaws(fakes, stage):
    """Return what drives jaws that move as a function of time: where and when they rest."""

    def drive(position, force_n=None, limit_s=10.0, stop_s=float("inf"), wait_s=(0.0, 0.0)):
        robot = stage.Scripted(Robot)
        context = fakes.Context(robot=robot)
        context.jaw = position
        steps = drive_jaws(
            context,
            0.3,
            force_n,
            lambda: context.time_s > stop_s,
            lambda: wait_s[0] < context.time_s < wait_s[1],
        )
        try:
            while context.time_s < limit_s:
                next(steps)
                context.time_s += fakes.TICK_S
        except StopIteration as end:
            commands = [one["command"] for one in robot.calls("command")]
            return end.value, context.time_s, commands, context.machine()
        return None

    return drive


def test_jaws_that_do_not_move_are_at_rest_after_half_a_second(jaws):
    angle_rad, at_s, (command,), machine = jaws(lambda time_s: 0.8)
    assert (angle_rad, at_s) == (0.8, pytest.approx(0.5, abs=0.051))
    assert isinstance(command, MoveJaws)
    assert (command.position_rad, command.force_n) == (0.3, machine.gripper.tip_force_n)


def test_a_given_force_is_commanded(jaws):
    (command,) = jaws(lambda time_s: 0.8, force_n=1234.0)[2]
    assert command.force_n == 1234.0


def test_jaws_that_have_to_stop_are_commanded_to_where_they_are(jaws):
    angle_rad, at_s, commands, _ = jaws(lambda time_s: 0.9 - 0.2 * min(time_s, 1.0), stop_s=1.0)
    assert [one.position_rad for one in commands] == [0.3, pytest.approx(0.7)]
    assert (angle_rad, at_s) == (pytest.approx(0.7), pytest.approx(1.55, abs=0.051))


def test_jaws_that_have_to_wait_stay_where_they_are_and_go_on_then(jaws):
    angle_rad, at_s, commands, _ = jaws(
        lambda time_s: 0.9 - 0.2 * min(time_s, 1.0), wait_s=(1.0, 2.5)
    )
    assert [one.position_rad for one in commands] == [0.3, pytest.approx(0.7), 0.3]
    assert (angle_rad, at_s) == (pytest.approx(0.7), pytest.approx(3.05, abs=0.11))


def test_jaws_rest_a_window_after_they_have_stopped(jaws):
    angle_rad, at_s, *_ = jaws(lambda time_s: max(0.9 - 0.4 * time_s, 0.3))
    assert angle_rad == pytest.approx(0.3)
    assert 1.5 + 0.5 <= at_s <= 1.5 + 2 * 0.55 + 0.05  # they stop at 1.5 s, between two looks


@pytest.mark.parametrize(("rate", "is_at_rest"), [(0.018, True), (-0.018, True), (0.022, False)])
def test_jaws_that_creep_by_less_than_ten_milliradians_in_the_window_rest(jaws, rate, is_at_rest):
    assert (jaws(lambda time_s: 0.5 + rate * time_s) is not None) is is_at_rest
