"""The checks of a drive itself: what it stops for, from where on, and what it records."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.driving.planner import Dubins
from executive_plugins.driving.settings import DubinsSettings

from executive.errors import RobotError
from executive.messages.command import Drive
from executive.messages.drive import DriveTrouble
from tests.behaviours.test_driving_leaves import MACHINE, SCAN, failure, leaf, on_wheels


class Straight(Dubins):
    """A planner of real ways whose first steering may be replaced."""

    def __init__(self, **changes):
        super().__init__(DubinsSettings(), MACHINE)
        self.changes = changes

    def steer(self, path, along_m, T_map_base):
        return replace(super().steer(path, along_m, T_map_base), **self.changes)


def test_a_robot_that_refuses_a_drive_under_way_ends_it(fakes):
    context, robot = on_wheels(fakes)
    take = robot.command

    def command(given):
        if isinstance(given, Drive) and context.time_s > 6:
            raise RobotError("a wheel is blocked")
        take(given)

    robot.command = command
    assert failure(fakes, context) == (DriveTrouble.REFUSED, "refused: a wheel is blocked")
    assert robot.stops == 1


def test_a_machine_that_rolls_on_after_it_was_told_to_stand_has_failed(fakes):
    context, robot = on_wheels(fakes)
    robot.stop = lambda: None
    advance = robot.driver.advance

    def command(given):  # the brake does nothing
        if isinstance(given, Drive) and given.speed_m_s:
            robot.driver.command(given, SCAN, arm_moves=False)

    robot.command = command
    robot.driver.advance = lambda dt_s: (robot.driver.command(Drive(0.3, 0.0), SCAN,
        arm_moves=False) if context.time_s > 4 else None, advance(dt_s))  # fmt: skip
    trouble, reason = failure(fakes, context)
    assert trouble is DriveTrouble.OFF_PATH
    assert reason.endswith("0.30 m/s after it was told to stand")


@pytest.mark.parametrize(("off_m", "is_stopped"), [(0.49, False), (0.51, True)])
def test_a_path_is_left_from_half_a_metre_on(fakes, off_m, is_stopped):
    context, _ = on_wheels(fakes, driving=Straight(off_m=off_m))
    outcome = fakes.finish(leaf(context, place=[8, 0], heading=0))
    assert outcome.success is not is_stopped
    if is_stopped:
        assert outcome.reason.endswith("the machine is 0.51 m off its path")


@pytest.mark.parametrize(("over_rad", "is_stopped"), [(0.04, False), (0.06, True)])
def test_a_lean_beyond_the_machines_limit_and_a_margin_stops_it(fakes, over_rad, is_stopped):
    tilt_rad = MACHINE.driving.max_slope_rad + over_rad
    context, _ = on_wheels(fakes, tilt_rad=tilt_rad)
    outcome = fakes.finish(leaf(context, place=[8, 0], heading=0))
    assert outcome.success is not is_stopped
    if is_stopped:
        lean, most = np.degrees([tilt_rad, MACHINE.driving.max_slope_rad])
        told = f"the chassis leans by {lean:.0f}°, and it drives on up to {most:.0f}°"
        assert outcome.reason.endswith(told)


def test_how_far_it_stands_off_its_goal_and_how_long_it_took_is_recorded(fakes):
    context, robot = on_wheels(fakes)
    assert fakes.finish(leaf(context, place=[8, 1], heading=0.2)).success
    begun, ended = context.events
    x, y, yaw = robot.driver.pose_map
    assert begun.goal_map == pytest.approx([8.0, 1.0, 0.2])
    assert begun.length_m == pytest.approx(np.hypot(8, 1), abs=0.2)
    assert ended.off_m == pytest.approx(np.hypot(x - 8.0, y - 1.0), abs=1e-6)
    assert ended.off_rad == pytest.approx(abs(yaw - 0.2), abs=1e-6)
    assert 4.0 < ended.lasted_s < context.time_s


def slow_legs(context, legs_s=6.0):
    """Let the machine take so long to raise its legs, or to stand on them again."""
    driving = MACHINE.driving.model_copy(update={"legs_s": legs_s})
    context.machine = lambda: MACHINE.model_copy(update={"driving": driving})
    return context


def test_a_machine_on_legs_has_time_to_raise_them_and_to_stand_on_them(fakes):
    times = []
    for legs_s in (0.0, 6.0):
        context, robot = on_wheels(fakes)
        take, began_s = robot.command, legs_s
        robot.command = lambda given, take=take, context=context, began_s=began_s: (
            take(given) if context.time_s > began_s else None
        )
        outcome = fakes.finish(leaf(slow_legs(context, legs_s), place=[8, 0], heading=0))
        assert outcome.success, outcome.reason
        times.append(context.time_s)
    braking_s = 0.6  # which the time to stand on the legs contains
    assert 12.0 - braking_s < times[1] - times[0] < 12.2


def test_legs_that_are_never_raised_are_a_machine_that_does_not_move(fakes):
    context, robot = on_wheels(fakes)
    robot.stuck = True
    trouble, reason = failure(fakes, slow_legs(context))
    assert trouble is DriveTrouble.NOT_MOVING
    assert "for 9.0 s" in reason or "for 9.1 s" in reason
