"""The machine without a world moves exactly as it is told and measures what follows from it."""

import numpy as np
import pytest
from executive_plugins.robot.kinematic import KinematicRobot
from executive_plugins.robot.settings import KinematicSettings

from executive.errors import RobotError
from executive.machine.machine import load_machine
from executive.messages.command import Drive, Follow, MoveJaws
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.trajectory import JointTrajectory

STEP_S = 0.01


@pytest.fixture
def machine():
    return load_machine("m545")


@pytest.fixture
def robot(machine):
    return KinematicRobot(KinematicSettings(), machine)


def turn(machine, angle, duration):
    """A smooth turn of the cabin from its posture."""
    times = np.linspace(0, duration, 60)
    start = machine.postures["scan"][machine.turn_joint]
    u = times / duration
    position = start + angle * (3 * u**2 - 2 * u**3)
    velocity = angle * (6 * u - 6 * u**2) / duration
    return JointTrajectory((machine.turn_joint,), times, position[:, None], velocity[:, None])


def test_arrives_at_the_trajectorys_end(robot, machine):
    robot.command(Follow(turn(machine, 1.0, 5.0)))
    samples = [o for o in robot.read(6.0) if isinstance(o, JointSample)]
    assert samples[-1].of(machine.turn_joint)[0] == pytest.approx(
        machine.postures["scan"][machine.turn_joint] + 1.0
    )


def test_at_rest_the_imu_measures_gravity_only(robot):
    sample = next(o for o in reversed(robot.read(1.0)) if isinstance(o, ImuSample))
    np.testing.assert_allclose(np.linalg.norm(sample.specific_force_m_s2), 9.81, atol=1e-6)
    np.testing.assert_allclose(sample.angular_velocity_rad_s, 0, atol=1e-9)


def test_the_cabins_imu_measures_the_turn(robot, machine):
    robot.command(Follow(turn(machine, 1.0, 5.0)))
    cabin = [o for o in robot.read(5.0) if isinstance(o, ImuSample) and o.frame == "imu_cabin"]
    assert sum(o.angular_velocity_rad_s[2] for o in cabin) * 0.01 == pytest.approx(1.0, abs=1e-6)


def test_a_stop_is_on_the_path_and_resume_goes_on_to_its_end(robot, machine):
    goal = machine.postures["scan"][machine.turn_joint] + 1.0
    robot.command(Follow(turn(machine, 1.0, 5.0)))
    robot.read(2.0)
    robot.stop()
    stopped = [o for o in robot.read(8.0) if isinstance(o, JointSample)][-1].of(machine.turn_joint)
    assert stopped[1] == 0.0
    assert 0.2 < goal - stopped[0] < 0.8
    robot.resume()
    end = [o for o in robot.read(16.0) if isinstance(o, JointSample)]
    assert end[-1].of(machine.turn_joint)[0] == pytest.approx(goal)
    speeds = np.array([o.of(machine.turn_joint)[1] for o in end])
    limit = machine.max_acceleration[machine.arm_names.index(machine.turn_joint)]
    assert np.abs(np.diff(speeds)).max() / 0.01 < 1.1 * limit


def test_a_stop_takes_the_time_that_the_command_asks_for_and_a_safe_stop_does_not(machine):
    turned = {}
    for how in ("stop", "safe_stop"):
        robot = KinematicRobot(KinematicSettings(), machine)
        robot.command(Follow(turn(machine, 1.0, 5.0), stop_s=2.0))
        robot.read(2.0)
        robot.safe_stop("a person") if how == "safe_stop" else robot.stop()
        samples = [o for o in robot.read(8.0) if isinstance(o, JointSample)]
        turned[how] = sum(o.of(machine.turn_joint)[1] != 0.0 for o in samples) * STEP_S
    assert turned["stop"] == pytest.approx(2.0, abs=0.1)
    assert turned["safe_stop"] < 1.0


@pytest.mark.parametrize("at_s", [0.3, 1.0, 2.5, 4.0, 4.7])
def test_after_a_pause_it_is_as_far_as_without_one(robot, machine, at_s):
    """Wherever the path was interrupted: accelerating loses as much as braking has gained."""
    undisturbed = KinematicRobot(KinematicSettings(), machine)
    for one in (robot, undisturbed):
        one.command(Follow(turn(machine, 1.0, 5.0)))
    robot.read(at_s)
    robot.stop()
    robot.paused(at_s)
    now_s = at_s + 3.0
    robot.read(now_s)
    robot.resume()
    while robot.behind_s() > 0.0:
        now_s += 0.05
        robot.read(now_s)
    robot.resumed(at_s)
    for later_s in (1.5, 2.0, 5.0):
        found, wanted = (
            one.read(until_s)[-1].of(machine.turn_joint)[0]
            for one, until_s in ((robot, now_s + later_s), (undisturbed, at_s + later_s))
        )
        assert found - wanted == pytest.approx(0.0, abs=0.05 * 0.4)  # a tick at the top speed
    assert found == pytest.approx(wanted)


def test_closing_jaws_meet_the_pretended_stone(machine):
    robot = KinematicRobot(KinematicSettings(jaws_stop_at=0.3), machine)
    robot.command(MoveJaws(0.0, 1e4))
    assert [o for o in robot.read(5.0) if isinstance(o, JointSample)][-1].of(machine.jaw.name)[
        0
    ] == pytest.approx(0.3)


def test_can_be_told_to_fail(machine):
    robot = KinematicRobot(KinematicSettings(fails_at_s=1.0), machine)
    robot.read(0.9)
    with pytest.raises(RobotError, match=r"has not answered since 1\.00 s"):
        robot.read(1.0)


def test_a_machine_that_is_restored_goes_on_like_the_one_that_was_kept(robot, machine):
    """In the midst of a turn, of the jaws' closing, and of what its sensors remember."""
    robot.command(Follow(turn(machine, 1.0, 5.0)))
    robot.command(MoveJaws(0.1, 5e3))
    robot.read(1.5)
    other = KinematicRobot(KinematicSettings(), machine)
    other.restore(robot.keep())
    assert other.revision == robot.revision
    ours, theirs = (list(made.read(2.5)) for made in (robot, other))
    assert len(ours) == len(theirs) > 100
    for one, same in zip(ours, theirs, strict=True):
        assert type(one) is type(same)
        assert one.stamp_s == same.stamp_s
        if isinstance(one, JointSample):
            assert one.of(machine.turn_joint) == same.of(machine.turn_joint)
            assert one.of(machine.jaw.name) == same.of(machine.jaw.name)
        if isinstance(one, ImuSample):
            np.testing.assert_array_equal(one.specific_force_m_s2, same.specific_force_m_s2)
    last = [one for one in theirs if isinstance(one, JointSample)][-1]
    assert last.of(machine.turn_joint)[1] > 0.1


def poses_of_imu(robot, seconds):
    """Return what the chassis' sensor feels ahead while the time goes on [m/s²]."""
    samples = robot.read(robot.revision * STEP_S + seconds)
    return [o for o in samples if isinstance(o, ImuSample) and o.frame == "imu_base"]


def test_it_drives_and_brakes_and_its_sensor_feels_that(robot, machine):
    """Up to 0.5 m/s with the largest acceleration, then braking as hard."""
    limit = machine.driving.max_acceleration_m_s2
    robot.command(Drive(0.5, 0.0))
    felt = poses_of_imu(robot, 0.2)
    assert felt[-1].specific_force_m_s2[0] == pytest.approx(limit, abs=1e-3)
    with pytest.raises(RobotError, match="the chassis moves"):
        robot.command(Follow(turn(machine, 0.1, 2.0)))
    robot.stop()
    felt = poses_of_imu(robot, 0.1)
    assert felt[-1].specific_force_m_s2[0] == pytest.approx(-limit, abs=1e-3)
    felt = poses_of_imu(robot, 2.0)
    assert felt[-1].specific_force_m_s2[0] == pytest.approx(0.0, abs=1e-6)
    robot.command(Follow(turn(machine, 0.1, 2.0)))  # it stands: the arm may move


def test_it_does_not_drive_while_the_arm_moves(robot, machine):
    robot.command(Follow(turn(machine, 0.5, 3.0)))
    robot.read(0.5)
    with pytest.raises(RobotError, match="the arm moves"):
        robot.command(Drive(0.5, 0.0))


def test_a_safe_stop_is_kept_until_all_stands(robot, machine):
    robot.command(Drive(0.5, 0.0))
    robot.read(0.3)
    assert robot.latched() == ""
    robot.safe_stop("a test")
    assert robot.latched() == "a test"
    for command in (Drive(0.5, 0.0), MoveJaws(0.1, 1e3), Follow(turn(machine, 0.1, 2.0))):
        with pytest.raises(RobotError, match="a test"):
            robot.command(command)
    with pytest.raises(RobotError):
        robot.reset()
    robot.read(2.0)
    robot.reset()
    assert robot.latched() == ""
    robot.command(Drive(0.5, 0.0))


def jaw(robot, machine, until_s):
    samples = [o for o in robot.read(until_s) if isinstance(o, JointSample)]
    return samples[-1].of(machine.jaw.name)[0]


def test_jaws_wait_in_a_pause_and_hold_after_a_safe_stop(robot, machine):
    goal = 0.2
    robot.command(MoveJaws(goal, 1e3))
    before = jaw(robot, machine, 0.3)
    assert before > goal + 0.1
    robot.paused(0.3)
    assert jaw(robot, machine, 1.0) == before
    robot.resumed(0.3)
    assert jaw(robot, machine, 1.2) < before
    robot.safe_stop("a test")
    stopped = jaw(robot, machine, 1.3)
    assert jaw(robot, machine, 6.0) == stopped
    assert stopped > goal
    robot.resumed(1.2)
    assert jaw(robot, machine, 8.0) == stopped  # what a safe stop has ended goes on no more
