import numpy as np
import pytest
from executive_plugins.robot.mujoco.machine.wheels import standing_on
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings

from executive.errors import RobotError
from executive.geometry.pose import inverse
from executive.machine.machine import load_machine
from executive.messages.command import Drive, Follow
from executive.messages.imu import ImuSample
from executive.testing.exercises.robot import turn

TICK_S = 0.05
BARE = {"site": {"stones": {"count": 0}}}


@pytest.fixture
def machine():
    return load_machine("m545")


def started(machine, base):
    settings = MujocoSettings.model_validate({"base": base, **BARE})
    robot = MujocoRobot(settings, machine, np.random.default_rng(0))
    robot.start()
    return robot


def test_it_stands_on_a_slope_as_the_ground_says(machine):
    slope = np.array([0.1, -0.05])
    T = standing_on(lambda places: places @ slope + 2.0, machine, np.array([3.0, 1.0, 0.7]))
    up = np.array([-0.1, 0.05, 1.0])
    np.testing.assert_allclose(T[:3, 2], up / np.linalg.norm(up), atol=1e-9)
    foot = T[:3, 3] - machine.stance.base_height_m * T[:3, 2]
    np.testing.assert_allclose(foot, [3.0, 1.0, 3.0 * 0.1 - 0.05 + 2.0], atol=1e-9)
    assert np.arctan2(T[1, 0], T[0, 0]) == pytest.approx(0.7, abs=1e-9)
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-12)


def test_it_drives_is_felt_and_brakes_when_commands_cease(machine):
    robot, felt = started(machine, "on_wheels"), []
    base = machine.base_link
    for k in range(1, 101):
        if k < 50:
            robot.command(Drive(0.8, 0.0))
        felt += [one for one in robot.read(k * TICK_S) if isinstance(one, ImuSample)]
    T = robot.world.T_world_body(base)
    assert 1.9 < T[0, 3] < 2.5  # 0.8 m/s at 2 s, braking from 2.8 s on
    assert abs(T[1, 3]) < 0.01
    assert not robot.world.is_moving
    ahead = [one.specific_force_m_s2[0] for one in felt if one.frame == "imu_base"]
    limit = machine.driving.max_acceleration_m_s2
    assert np.mean(ahead[20:150]) == pytest.approx(limit, abs=0.1)
    robot.command(Drive(0.5, 0.0))
    start = robot.world.arm.position()
    with pytest.raises(RobotError, match="the chassis moves"):
        robot.command(Follow(turn(machine.arm_names, machine.turn_joint, start, 0.1, 2.0)))
    robot.safe_stop("a test")
    with pytest.raises(RobotError, match="a safe stop is latched"):
        robot.command(Drive(0.5, 0.0))


def test_the_chassis_holds_while_the_arm_turns(machine):
    robot = started(machine, "on_wheels")
    before = robot.world.T_world_body(machine.base_link)
    start = robot.world.arm.position()
    robot.command(Follow(turn(machine.arm_names, machine.turn_joint, start, 0.4, 2.0)))
    for k in range(1, 41):
        robot.read(k * TICK_S)
    moved = inverse(before) @ robot.world.T_world_body(machine.base_link)
    np.testing.assert_allclose(moved, np.eye(4), atol=1e-3)


def test_a_welded_machine_refuses(machine):
    with pytest.raises(RobotError, match="to on_legs or on_wheels"):
        started(machine, "welded").command(Drive(0.5, 0.0))
