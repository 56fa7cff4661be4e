"""What every robot must do: measure in order, move as commanded, stop, and answer for itself."""

import numpy as np
import pytest

from executive.errors import DataError, RobotError
from executive.interfaces.robot import Robot, RobotSettings
from executive.machine.machine import Machine
from executive.messages.command import Follow, LimitStop, SwitchLidars
from executive.messages.joints import JointSample
from executive.testing.exercises.robot import TICK_S, arm_of, newest_joints, turn
from executive.testing.pytest_plugin import Insist
from executive.testing.subject import Subject

CAPABILITY = "robot"
REST_RAD_S = 0.01  # a joint slower than this is at rest, as the mission's leaves take it
TOLERANCE_RAD = 0.05  # what a hydraulic arm may be off its path's end
LATE_S = 0.5  # how late a busy computer may read a machine that lives by its own clock


def sample_of(robot: Robot, until_s: float, insist: Insist) -> JointSample:
    """Return the newest joint sample of the ticks up to a time."""
    sample = None
    for k in range(1, round(until_s / TICK_S) + 1):
        sample = newest_joints(robot.read(k * TICK_S)) or sample
    insist(sample is not None, f"it sends no joint sample within {until_s} s")
    assert sample is not None
    return sample


def test_its_settings_name_the_machine(subject: Subject) -> None:
    assert issubclass(subject.plugin_class.Settings, RobotSettings)


def test_its_measurements_come_in_order_of_stamps(plugin: Robot) -> None:
    ahead_s = LATE_S if plugin.has_own_clock else 1e-6
    for k in range(1, 11):
        stamps = [one.stamp_s for one in plugin.read(k * TICK_S)]
        assert stamps == sorted(stamps), f"the observations of tick {k} are out of order"
        assert all(stamp <= k * TICK_S + ahead_s for stamp in stamps), "a stamp lies in the future"


def test_no_measurement_comes_twice(plugin: Robot) -> None:
    seen = [
        (type(one).__name__, getattr(one, "frame", getattr(one, "antenna", "")), one.stamp_s)
        for k in range(1, 11)
        for one in plugin.read(k * TICK_S)
    ]
    assert len(seen) == len(set(seen))


def test_its_joints_are_those_of_the_machine(
    plugin: Robot, machine: Machine, insist: Insist
) -> None:
    assert sample_of(plugin, 0.5, insist).names == machine.joint_names


def test_its_sensors_are_those_of_the_machine(plugin: Robot, machine: Machine) -> None:
    for one in plugin.read(0.5):
        name = getattr(one, "frame", getattr(one, "antenna", None))
        assert name is None or name in machine.sensors, f"the machine has no sensor '{name}'"


def test_it_follows_a_path_to_its_end(plugin: Robot, machine: Machine, insist: Insist) -> None:
    start = arm_of(machine.arm_names, sample_of(plugin, 0.5, insist))
    path = turn(machine.arm_names, machine.turn_joint, start, 0.1, 2.0)
    plugin.command(Follow(path))
    sample = None
    for k in range(11, 91):  # two seconds for the path, two for the machine to come to rest
        sample = newest_joints(plugin.read(k * TICK_S)) or sample
    assert sample is not None
    np.testing.assert_allclose(
        arm_of(machine.arm_names, sample), path.position[-1], atol=TOLERANCE_RAD
    )


def test_it_stops_within_the_acceleration_limits(
    plugin: Robot, machine: Machine, insist: Insist
) -> None:
    start = arm_of(machine.arm_names, sample_of(plugin, 0.5, insist))
    plugin.command(Follow(turn(machine.arm_names, machine.turn_joint, start, 0.4, 4.0)))
    for k in range(11, 41):
        plugin.read(k * TICK_S)
    plugin.stop()
    sample = None
    for k in range(41, 101):
        sample = newest_joints(plugin.read(k * TICK_S)) or sample
    assert sample is not None
    speed = np.abs([sample.of(name)[1] for name in machine.arm_names]).max()
    assert speed < REST_RAD_S, f"three seconds after the stop a joint moves with {speed:.3f} rad/s"
    turned = sample.of(machine.turn_joint)[0] - start[machine.arm_names.index(machine.turn_joint)]
    assert turned < 0.39, "it went to the end of its path, whatever the stop said"


def test_it_refuses_a_path_that_begins_elsewhere(
    plugin: Robot, machine: Machine, insist: Insist
) -> None:
    start = arm_of(machine.arm_names, sample_of(plugin, 0.5, insist))
    elsewhere = turn(machine.arm_names, machine.turn_joint, start + 0.5, 0.1, 2.0)
    with pytest.raises((RobotError, DataError)):
        plugin.command(Follow(elsewhere))


def test_a_second_stop_gives_the_path_up(plugin: Robot, machine: Machine, insist: Insist) -> None:
    start = arm_of(machine.arm_names, sample_of(plugin, 0.5, insist))
    plugin.command(Follow(turn(machine.arm_names, machine.turn_joint, start, 0.4, 4.0)))
    for k in range(11, 31):
        plugin.read(k * TICK_S)
    plugin.stop()
    plugin.stop()
    for k in range(31, 91):
        plugin.read(k * TICK_S)
    at_rest = newest_joints(plugin.read(91 * TICK_S))
    plugin.resume()
    sample = at_rest
    for k in range(92, 132):
        sample = newest_joints(plugin.read(k * TICK_S)) or sample
    assert at_rest is not None
    assert sample is not None
    moved = sample.of(machine.turn_joint)[0] - at_rest.of(machine.turn_joint)[0]
    assert abs(moved) < TOLERANCE_RAD, "it went on along a path that had been given up"


def test_a_safe_stop_refuses_motion_until_it_is_reset(
    plugin: Robot, machine: Machine, insist: Insist
) -> None:
    start = arm_of(machine.arm_names, sample_of(plugin, 0.5, insist))
    path = Follow(turn(machine.arm_names, machine.turn_joint, start, 0.1, 2.0))
    plugin.safe_stop("a test of the latch")
    assert "a test of the latch" in plugin.latched()
    with pytest.raises((RobotError, DataError)):
        plugin.command(path)
    plugin.command(SwitchLidars(on=False))  # moves nothing
    plugin.command(LimitStop(0.5))  # neither does this
    plugin.reset()
    assert plugin.latched() == ""
    plugin.command(path)
