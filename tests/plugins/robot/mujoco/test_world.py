"""The machine in its world: standing still, tracking with a load, holding a stone without creeping,
determinism.
"""

from collections.abc import Sequence

import numpy as np
import pytest
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.site.settings import (
    SiteSettings,
    StoneSettings,
    TerrainSettings,
)
from executive_plugins.robot.mujoco.site.site import Site, make_site
from executive_plugins.robot.mujoco.site.stone_model import StoneModel
from executive_plugins.robot.mujoco.site.terrain import make_terrain
from executive_plugins.robot.mujoco.world import World

from executive.errors import ConfigError, RobotError
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import inverse, pose
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.command import Follow, MoveJaws
from executive.messages.trajectory import JointTrajectory

BLOCK_M = (1.1, 0.84, 0.8)  # 2 t at 2,700 kg/m³


def level_world(machine: Machine, stones: Sequence[tuple[np.ndarray, np.ndarray]] = ()) -> World:
    """Make a world of level rock and boxes: their sides [m] and their poses."""
    level = TerrainSettings(undulation_m=0, roughness_m=0, loose_m=0)
    terrain = make_terrain(level, np.random.default_rng(0))
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    models = [
        StoneModel.from_skin(f"stone_{i}", hull_mesh(corners * sides), 2700.0)
        for i, (sides, _) in enumerate(stones, start=1)
    ]
    return World(
        machine, Site(terrain, tuple(models), tuple(T for _, T in stones)), PhysicsSettings()
    )


def run(world: World, duration_s: float) -> None:
    for _ in range(round(duration_s / 0.01)):
        world.step()


def move(world: World, goal: np.ndarray) -> float:
    """Move with the loaded limits and return the gripper's largest distance from the path in time
    [m].
    """
    machine, kinematics = world.machine, Kinematics(world.machine)
    start = world.arm.position()
    way = np.abs(goal - start)
    speed, acceleration = machine.loaded_max_velocity, machine.loaded_max_acceleration
    duration_s = max(1.0, (1.875 * way / speed).max(), np.sqrt(5.78 * way / acceleration).max())
    u = np.linspace(0, 1, 80)
    share, slope = (
        10 * u**3 - 15 * u**4 + 6 * u**5,
        (30 * u**2 - 60 * u**3 + 30 * u**4) / duration_s,
    )
    trajectory = JointTrajectory(
        machine.arm_names,
        u * duration_s,
        start + np.outer(share, goal - start),
        np.outer(slope, goal - start),
    )
    begin_s, worst_m = world.time_s, 0.0
    world.follow(Follow(trajectory))
    while world.is_moving:
        world.step()
        wanted = kinematics.gripper(trajectory.at(world.time_s - begin_s)[0])[:3, 3]
        worst_m = max(
            worst_m, float(np.linalg.norm(kinematics.gripper(world.arm.position())[:3, 3] - wanted))
        )
    return worst_m


@pytest.mark.parametrize("name", ["m545", "mini"])
def test_a_machine_stands_still_in_its_posture(name: str) -> None:
    machine = load_machine(name)
    world = level_world(machine)
    run(world, 2.0)
    np.testing.assert_allclose(world.arm.position(), machine.posture("scan"), atol=1e-6)
    assert np.abs(world.arm.velocity()).max() < 1e-6
    assert world.data.ncon == 0


def hanging(boom: float, dipper: float, tele: float) -> np.ndarray:
    """Return an arm of the M545 with the gripper straight down."""
    return np.array([0.0, boom, dipper, tele, -0.14 - boom - dipper, 0.0, np.pi / 2])


def arm_over(machine: Machine, palm_above_ground_m: float) -> np.ndarray:
    """Return an arm whose palm hangs at a height: the telescope lowers it monotonically."""
    kinematics, low, high = Kinematics(machine), 0.0, 1.769
    for _ in range(40):
        middle = (low + high) / 2
        height = (
            kinematics.gripper(hanging(0.95, -0.25, middle))[2, 3] + machine.stance.base_height_m
        )
        low, high = (middle, high) if height > palm_above_ground_m else (low, middle)
    return hanging(0.95, -0.25, low)


def test_a_held_stone_of_two_tonnes_neither_creeps_nor_pulls_the_arm_off_its_path() -> None:
    machine = load_machine("m545")
    gripper = machine.gripper
    tip_depth_m = gripper.tips(gripper.jaw_rad(BLOCK_M[1]))[0, 0]
    arm = arm_over(machine, tip_depth_m + 0.1)
    x, y = Kinematics(machine).gripper(arm)[:2, 3]
    turned = np.array(
        [[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]
    )  # the jaws open along the world's x at yaw π/2
    world = level_world(
        machine, [(np.array(BLOCK_M), pose(turned, np.array([x, y, BLOCK_M[2] / 2 + 0.005])))]
    )
    world.move_jaws(MoveJaws(machine.jaw.open_rad, 20e3))
    high = arm + np.array([0, 0.2, 0, 0, -0.2, 0, 0])
    move(world, high)
    move(world, arm)
    world.move_jaws(MoveJaws(0.0, 35e3))
    run(world, 2.5)
    assert move(world, high) < 0.03  # the weight is taken over at the start
    assert move(world, high + np.eye(7)[0] * 0.8) < 0.02
    first = inverse(world.T_world_body("gripper")) @ world.T_world_body("stone_1")
    run(world, 2.0)
    second = inverse(world.T_world_body("gripper")) @ world.T_world_body("stone_1")
    assert world.T_world_body("stone_1")[2, 3] > 0.8
    assert np.linalg.norm(second[:3, 3] - first[:3, 3]) / 2.0 < 1e-3  # [m/s]
    np.testing.assert_allclose(world.arm.position(), high + np.eye(7)[0] * 0.8, atol=2e-3)


def test_the_boom_carries_what_the_jaws_hold() -> None:
    """Statics: the boom's torque balances the machine's own weights, J^T m g of each link beyond
    it.
    """
    machine = load_machine("m545")
    world = level_world(machine)
    run(world, 1.0)
    boom = world.T_world_body("boom")[:3, 3]
    torque = 0.0
    for name in (
        "boom",
        "dipper",
        "tele",
        "ee_pitch",
        "ee_roll",
        "gripper",
        "jaw_left",
        "jaw_right",
    ):
        link = machine.links[name]
        centre = world.T_world_body(name) @ np.append(link.com_m, 1.0)
        torque += link.mass_kg * 9.81 * (centre[0] - boom[0])
    assert world.arm.effort()[1] == pytest.approx(torque, rel=1e-3)


def test_the_jaws_close_at_their_speed_and_keep_to_the_commanded_angle() -> None:
    machine = load_machine("m545")
    world = level_world(machine)
    world.move_jaws(MoveJaws(0.9, 20e3))
    run(world, 1.0)
    assert world.jaws.velocity_rad_s == pytest.approx(machine.jaw.max_velocity, rel=0.05)
    run(world, 3.0)
    assert world.jaws.position_rad == pytest.approx(0.9, abs=0.01)
    mirror = world.data.joint(machine.jaw.mirror_name).qpos[0]
    assert mirror == pytest.approx(world.jaws.position_rad, abs=1e-3)


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (MoveJaws(1.5, 1e3), "the range is 0.0 to 0.94 rad"),
        (MoveJaws(0.1, 9e4), "the largest is 35000 N"),
    ],
)
def test_refuses_what_the_jaws_cannot_do(command: MoveJaws, words: str) -> None:
    with pytest.raises(RobotError, match=words):
        level_world(load_machine("m545")).move_jaws(command)


def test_jaws_that_have_moved_come_to_rest() -> None:
    """The right jaw, tied to the driven one, swung on at 14 Hz, and shook what the arm weighs."""
    machine = load_machine("m545")
    world = level_world(machine)
    arm_rad = np.array([0.052, 1.28, -0.228, 0.029, -1.473, -0.425, -0.359])
    world._set_arm(arm_rad)
    for target_rad in (0.329, 0.563):
        world.move_jaws(MoveJaws(target_rad, 35000.0))
        for _ in range(800):
            world._substep(arm_rad, np.zeros(len(arm_rad)))
    right = world.data.joint(machine.jaw.mirror_name)
    assert abs(float(right.qpos[0]) - 0.563) < 0.01
    assert abs(float(right.qvel[0])) < 0.01


@pytest.mark.parametrize("force_n", [2000.0, 35000.0])
def test_jaws_that_move_keep_their_speed(force_n: float) -> None:
    """They chattered: the torque of the drive swung between both of its limits, by 179 kN·m."""
    machine = load_machine("m545")
    world = level_world(machine)
    arm_rad = np.array([1.898, 1.03, -0.489, 0.491, -0.313, -0.601, 1.61])
    world._set_arm(arm_rad)
    jaw, torques = machine.jaw, []
    left, right = (world.data.joint(name) for name in (jaw.name, jaw.mirror_name))
    world.move_jaws(MoveJaws(jaw.upper, force_n))
    for step in range(640):  # 1.6 s
        world._substep(arm_rad, np.zeros(len(arm_rad)))
        if step < 200:
            continue
        assert float(left.qvel[0]) == pytest.approx(jaw.max_velocity, abs=0.01)
        assert float(right.qvel[0]) == pytest.approx(jaw.max_velocity, abs=0.01)
        torques.append(world.jaws.effort_nm)
    assert np.ptp(torques) < 1000.0


def test_two_runs_with_one_seed_are_equal_bit_for_bit() -> None:
    machine = load_machine("m545")
    settings = SiteSettings(stones=StoneSettings(count=3))
    states = []
    for _ in range(2):
        world = World(
            machine,
            make_site(settings, machine, PhysicsSettings(), np.random.default_rng(5)),
            PhysicsSettings(),
        )
        world.move_jaws(MoveJaws(0.9, 20e3))
        move(world, machine.posture("carry"))
        states.append(np.concatenate([world.data.qpos, world.data.qvel]))
    np.testing.assert_array_equal(states[0], states[1])


def test_observers_are_called_once_a_control_step_with_poses_up_to_date() -> None:
    world = level_world(load_machine("mini"))
    times: list[float] = []
    world.observe(lambda seen: times.append(seen.time_s))
    run(world, 0.05)
    np.testing.assert_allclose(times, [0.01, 0.02, 0.03, 0.04, 0.05])


def test_refuses_an_integration_step_that_does_not_divide_the_control_step() -> None:
    machine = load_machine("mini")
    terrain = make_terrain(TerrainSettings(), np.random.default_rng(0))
    with pytest.raises(ConfigError, match=r"must divide 0\.01 s"):
        World(machine, Site(terrain, (), ()), PhysicsSettings(timestep_s=0.003))


def test_an_arm_that_presses_on_the_ground_does_not_wind_up_to_its_full_strength() -> None:
    machine = load_machine("m545")
    world = level_world(machine)
    tip_depth_m = machine.gripper.tips(0.0)[0, 0]
    move(world, arm_over(machine, tip_depth_m + 0.5))
    move(world, arm_over(machine, tip_depth_m - 0.01))  # 1 cm below the ground
    run(world, 8.0)
    push_n = sum(world.data.efc_force[contact.efc_address] for contact in world.data.contact)
    assert 5e3 < push_n < 3 * machine.payload_kg * 9.81
