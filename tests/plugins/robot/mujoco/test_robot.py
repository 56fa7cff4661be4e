"""The simulated machine as a mission sees it: observations in order, commands, the stop, chance by
seed.
"""

import numpy as np
import pytest
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings
from executive_plugins.robot.mujoco.site.settings import SiteSettings, StoneSettings

from executive.errors import RobotError
from executive.journal.value_file import from_bytes, to_bytes
from executive.machine.machine import load_machine
from executive.messages.command import Follow, MoveJaws, SwitchLidars
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.messages.trajectory import JointTrajectory

EMPTY = MujocoSettings(site=SiteSettings(stones=StoneSettings(count=0)))


def started(seed: int = 0, model: str = "m545") -> MujocoRobot:
    robot = MujocoRobot(EMPTY, load_machine(model), np.random.default_rng(seed))
    robot.start()
    return robot


def ticks(robot: MujocoRobot, until_s: float) -> list[Observation]:
    begin = round(robot.world.time_s / 0.05)
    return [
        o for tick in range(begin, round(until_s / 0.05)) for o in robot.read((tick + 1) * 0.05)
    ]


@pytest.mark.parametrize("model", ["m545", "mini"])
def test_measures_every_joint_of_any_machine(model: str) -> None:
    robot = started(model=model)
    samples = [o for o in ticks(robot, 0.5) if isinstance(o, JointSample)]
    machine = load_machine(model)
    assert samples[-1].names == machine.joint_names
    np.testing.assert_allclose(
        samples[-1].position[:-1], machine.posture("scan"), atol=2e-3
    )  # encoder noise


def test_a_call_for_the_same_time_gives_nothing_and_each_batch_is_in_order() -> None:
    robot = started()
    stamps = [o.stamp_s for o in robot.read(0.3)]
    assert stamps == sorted(stamps)
    assert robot.world.time_s == pytest.approx(0.3)
    assert not robot.read(0.3)


def test_lidars_measure_only_while_switched_on() -> None:
    robot = started()
    assert not any(isinstance(o, LidarScan) for o in ticks(robot, 0.3))
    robot.command(SwitchLidars(True))
    frames = {o.frame for o in ticks(robot, 0.6) if isinstance(o, LidarScan)}
    assert frames == {"lidar_vertical", "lidar_horizontal"}
    robot.command(SwitchLidars(False))
    ticks(robot, 0.7)
    assert not any(isinstance(o, LidarScan) for o in ticks(robot, 1.0))


def test_one_seed_gives_one_stream_and_another_another() -> None:
    first, again, other = (
        np.array(
            [o.specific_force_m_s2 for o in ticks(started(seed), 0.2) if isinstance(o, ImuSample)]
        )
        for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


def test_a_stop_in_mid_swing_brings_the_machine_to_rest_while_the_jaws_keep_their_command() -> None:
    robot = started()
    robot.command(MoveJaws(0.6, 20e3))
    u = np.linspace(0, 1, 50)
    share, slope = 10 * u**3 - 15 * u**4 + 6 * u**5, (30 * u**2 - 60 * u**3 + 30 * u**4) / 6
    robot.command(
        Follow(JointTrajectory(("J_TURN",), u * 6, 1.5 * share[:, None], 1.5 * slope[:, None]))
    )
    ticks(robot, 3.0)
    assert robot.world.arm.velocity()[0] > 0.3
    robot.stop()
    ticks(robot, 5.5)
    assert np.abs(robot.world.arm.velocity()).max() < 1e-3
    assert 0.7 < robot.world.arm.position()[0] < 1.4
    assert robot.world.jaws.position_rad == pytest.approx(0.6, abs=0.01)


def test_rays_from_above_find_the_ground() -> None:
    robot = started()
    origins, down = (
        np.array([[6.0, 0.0, 10.0], [0.0, 6.0, 10.0]]),
        np.array([[0.0, 0, -1], [0, 0, -1]]),
    )
    heights = 10.0 - robot.cast_rays(origins, down)
    np.testing.assert_allclose(
        heights, robot.world.site.terrain.height_at(origins[:, :2]), atol=0.02
    )


def test_a_robot_that_was_not_started_says_so() -> None:
    with pytest.raises(RobotError, match=r"call start\(\) first"):
        MujocoRobot(EMPTY, load_machine("m545"), np.random.default_rng(0)).read(0.1)


def test_a_world_goes_on_in_another_process_as_it_would_have_in_its_own() -> None:
    """In mid-motion: the state is read back from bytes, into a robot of the same seed."""
    one = started()
    names = one.world.machine.arm_names
    here = one.world.arm.position()
    there = here + np.array([0.3, *([0.0] * (len(here) - 1))])
    path = JointTrajectory(
        names, np.array([0.0, 2.0]), np.stack([here, there]), np.zeros((2, len(here)))
    )
    one.command(Follow(path))
    one.command(MoveJaws(0.3, 5e3))
    ticks(one, 0.7)
    kept = from_bytes(to_bytes(one.keep()))
    other = started()
    other.restore(kept)
    ticks(one, 1.2), ticks(other, 1.2)
    np.testing.assert_allclose(other.world.data.qpos, one.world.data.qpos, rtol=0, atol=1e-12)
    assert other.world.time_s == one.world.time_s
    assert other.truth_log.end_s == pytest.approx(1.2)
