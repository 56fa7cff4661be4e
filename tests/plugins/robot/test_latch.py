"""A latched safe stop: what moves is refused until it is reset, and the path is gone."""

import numpy as np
import pytest
from executive_plugins.robot.kinematic import KinematicRobot

from executive.errors import RobotError
from executive.machine.machine import load_machine
from executive.messages.command import Follow, MoveJaws, SwitchLidars
from executive.testing.exercises.robot import turn

MACHINE = load_machine("m545")


@pytest.fixture
def robot():
    return KinematicRobot(KinematicRobot.Settings(), MACHINE)


def path():
    return Follow(turn(MACHINE.arm_names, MACHINE.turn_joint, MACHINE.posture("scan"), 0.5, 4.0))


def test_what_moves_is_refused_and_the_message_names_reason_and_cure(robot):
    robot.safe_stop("the loop was late")
    for command in (path(), MoveJaws(0.2, 100.0)):
        with pytest.raises(RobotError, match=r"latched \(the loop was late\); reset the robot"):
            robot.command(command)
    robot.command(SwitchLidars(on=False))


def test_the_first_reason_is_kept(robot):
    robot.safe_stop("first")
    robot.safe_stop("second")
    assert robot.latched() == "first"


def test_a_machine_that_moves_is_not_reset(robot):
    robot.command(path())
    robot.read(2.0)
    robot.safe_stop("in mid-swing")
    with pytest.raises(RobotError, match="still moves"):
        robot.reset()
    robot.read(8.0)
    robot.reset()
    assert robot.latched() == ""


def test_after_a_reset_nothing_goes_on_by_itself(robot):
    robot.command(path())
    robot.read(2.0)
    robot.safe_stop("in mid-swing")
    robot.read(8.0)
    robot.reset()
    robot.resume()
    before = robot._q.copy()
    robot.read(10.0)
    np.testing.assert_array_equal(robot._q, before)
