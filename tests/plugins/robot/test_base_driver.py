import numpy as np
import pytest
from executive_plugins.robot.base_driver import BaseDriver, travel_error

from executive.errors import RobotError
from executive.machine.machine import load_machine
from executive.messages.command import DRIVE_HOLD_S, START_TOLERANCE, Drive

DT_S = 0.01


@pytest.fixture
def machine():
    return load_machine("m545")


@pytest.fixture
def driver(machine):
    return BaseDriver(machine)


def drive(driver, machine, command, **changes):
    given = {"arm": machine.posture("scan"), "arm_moves": False} | changes
    driver.command(command, given["arm"], arm_moves=given["arm_moves"])


def test_it_keeps_the_limits_and_stops_when_commands_cease(driver, machine):
    limits, speeds = machine.driving, []
    for k in range(1000):
        if k < 500 and k % 5 == 0:
            drive(driver, machine, Drive(0.8, 0.2))
        driver.advance(DT_S)
        speeds.append(driver.speed_m_s)
    assert max(speeds) == pytest.approx(0.8)
    assert np.abs(np.diff(speeds)).max() <= limits.max_acceleration_m_s2 * DT_S + 1e-12
    assert not driver.is_moving
    braked = next(k for k in range(500, 1000) if speeds[k] == 0.0) - 495
    assert braked * DT_S <= DRIVE_HOLD_S + limits.stop_s(0.8) + 2 * DT_S


def test_an_arc_has_the_commanded_radius(driver, machine):
    middle = np.array([0.0, 5.0])
    drive(driver, machine, Drive(0.0, 0.0))
    driver.curvature_1_m = 0.2  # the wheels are turned already
    for k in range(800):
        if k % 5 == 0:
            drive(driver, machine, Drive(0.5, 0.2))
        place = driver.advance(DT_S)
        assert np.linalg.norm(place[:2] - middle) == pytest.approx(5.0, abs=1e-6)


@pytest.mark.parametrize(
    ("command", "told"), [(Drive(5.0, 0.0), "the limit is 1.0"), (Drive(0.5, 1.0), "least radius")]
)
def test_a_command_beyond_a_limit_is_refused(driver, machine, command, told):
    with pytest.raises(RobotError, match=told):
        drive(driver, machine, command)
    assert not driver.is_moving


def test_it_drives_with_the_arm_at_rest_and_folded_only(driver, machine):
    with pytest.raises(RobotError, match="the arm moves"):
        drive(driver, machine, Drive(0.5, 0.0), arm_moves=True)
    with pytest.raises(RobotError, match="off the posture 'scan'"):
        drive(driver, machine, Drive(0.5, 0.0), arm=machine.posture("carry"))
    drive(
        driver, machine, Drive(0.0, 0.0), arm=machine.posture("carry")
    )  # to stand is always taken


def test_whole_turns_of_the_cabin_do_not_count(driver, machine):
    turned = machine.posture("scan")
    turned[0] += 2 * np.pi + 0.5 * START_TOLERANCE
    drive(driver, machine, Drive(0.5, 0.0), arm=turned)
    assert driver.is_moving


def test_the_arm_waits_until_the_chassis_stands(driver, machine):
    driver.check_at_rest()
    drive(driver, machine, Drive(0.5, 0.0))
    driver.advance(0.1)
    with pytest.raises(RobotError, match="the chassis moves"):
        driver.check_at_rest()
    driver.stop()
    for _ in range(200):
        driver.advance(DT_S)
    driver.check_at_rest()


def test_a_machine_without_wheels_refuses(machine):
    fixed = BaseDriver(machine.model_copy(update={"driving": None}))
    with pytest.raises(RobotError, match="does not drive"):
        fixed.command(Drive(0.1, 0.0), machine.posture("scan"), arm_moves=False)


def test_only_a_machine_that_drives_has_a_posture_for_it(machine):
    away = machine.posture("scan")
    away[1] -= 2 * START_TOLERANCE
    assert travel_error(machine, machine.posture("scan")) == ""
    assert machine.arm_names[1] in travel_error(machine, away)
    assert travel_error(machine.model_copy(update={"driving": None}), away) == ""


def test_a_joint_that_turns_on_and_on_may_be_whole_turns_away(machine):
    turned = machine.posture("scan")
    turned[machine.arm_names.index(machine.turn_joint)] += 4 * np.pi
    assert travel_error(machine, turned) == ""
    turned[machine.arm_names.index(machine.turn_joint)] += np.pi
    assert "3.14" in travel_error(machine, turned)
