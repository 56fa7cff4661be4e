"""A machine that raises its legs to drive, and stands on them again where it has braked."""

import numpy as np
import pytest
from executive_plugins.robot.mujoco.physics_settings import LegSettings, PhysicsSettings
from executive_plugins.robot.mujoco.site.settings import TerrainSettings
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.terrain import make_terrain
from executive_plugins.robot.mujoco.truth.ground_reaction import GroundReaction
from executive_plugins.robot.mujoco.world import World

from executive.errors import RobotError
from executive.geometry.rotation import yaw_of
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.machine import load_machine
from executive.messages.command import Drive, Follow
from executive.testing.exercises.robot import turn

M545 = load_machine("m545")
WEIGHT_N = GRAVITY_M_S2 * sum(link.mass_kg for link in M545.links.values())
STEP_S = 0.01
AHEAD = Drive(0.6, 0.1)


def world_of(slope_rad: float = 0.0, legs: LegSettings | None = None) -> World:
    """Return a machine on its legs on a pad, around which the ground slopes."""
    settings = TerrainSettings(undulation_m=0, roughness_m=0, slope_rad=slope_rad, half_size_m=25)
    terrain = make_terrain(settings, np.random.default_rng(0))
    return World(M545, Site(terrain, (), ()), PhysicsSettings(), "nominal", legs or LegSettings())


def drive(world: World, duration_s: float, command: Drive = AHEAD) -> None:
    """Command to drive at each tick."""
    for k in range(round(duration_s / STEP_S)):
        if k % 5 == 0:
            world.drive(command)
        world.step()


def wait(world: World, duration_s: float) -> None:
    for _ in range(round(duration_s / STEP_S)):
        world.step()


def swing(world: World) -> Follow:
    start = world.arm.position()
    return Follow(turn(M545.arm_names, M545.turn_joint, start, 0.3, 2.0))


@pytest.mark.parametrize("slope_rad", [0.0, 0.12])
def test_it_drives_on_raised_legs_and_stands_level_on_them_after_it(slope_rad: float) -> None:
    world = world_of(slope_rad)
    drive(world, 10.0)
    assert not world.legs.loads_n().any()  # none bears, and none is watched for tipping
    assert world.is_moving
    if slope_rad:
        assert world.legs.tilt_rad() > 0.05
    wait(world, 14.0)
    T = world.T_world_body(M545.base_link)
    assert 2.0 < T[0, 3] < 5.0
    assert yaw_of(T[:3, :3]) > 0.2
    assert not world.is_moving
    assert world.legs.tilt_rad() < np.radians(0.1)
    assert world.legs.loads_n().sum() == pytest.approx(WEIGHT_N, rel=0.03)
    assert world.legs.margin_m() > 0.5
    before = world.T_world_body(M545.base_link)
    world.follow(swing(world))
    wait(world, 1.0)
    sways_m = np.abs(world.T_world_body(M545.base_link) - before).max()
    assert 1e-5 < sways_m < 0.02  # it stands on springs, and nothing else holds it


def test_the_arm_moves_only_where_the_machine_stands() -> None:
    world = world_of()
    drive(world, 0.5)
    with pytest.raises(RobotError, match="raises its legs: the arm moves when it stands"):
        world.follow(swing(world))
    drive(world, 5.0)
    with pytest.raises(RobotError, match="the chassis moves"):
        world.follow(swing(world))
    world.stop()
    wait(world, 2.5)
    with pytest.raises(RobotError, match="puts its legs down: the arm moves when it stands"):
        world.follow(swing(world))
    wait(world, LegSettings().longest_s)
    world.follow(swing(world))
    with pytest.raises(RobotError, match="the arm moves"):
        world.drive(AHEAD)


def test_it_does_not_begin_to_raise_its_legs_for_a_command_that_is_refused() -> None:
    world = world_of()
    with pytest.raises(RobotError, match="the limit is"):
        world.drive(Drive(9.0, 0.0))
    assert not world.is_moving
    world.drive(Drive(0.0, 0.0))
    assert not world.is_moving


def test_without_a_further_command_it_stands_again_where_it_was() -> None:
    world = world_of()
    world.drive(AHEAD)
    wait(world, 10.0)
    assert not world.is_moving
    np.testing.assert_allclose(world.T_world_body(M545.base_link)[:2, 3], 0.0, atol=0.01)


def test_a_stop_while_the_legs_are_raised_puts_them_down() -> None:
    world = world_of()
    drive(world, 0.5)
    world.stop()
    wait(world, 6.0)
    assert not world.is_moving
    assert world.legs.loads_n().sum() == pytest.approx(WEIGHT_N, rel=0.03)


def test_after_a_safe_stop_no_leg_moves_until_the_machine_may_go_on() -> None:
    world = world_of()
    drive(world, 5.0)
    world.give_up()
    wait(world, 3.0)
    assert not world.is_moving
    out_m = world.legs.springs_m()
    wait(world, 2.0)
    np.testing.assert_array_equal(world.legs.springs_m(), out_m)
    with pytest.raises(RobotError, match="is on its wheels"):
        world.follow(swing(world))
    world.take_up()
    wait(world, 6.0)
    assert world.legs.loads_n().sum() == pytest.approx(WEIGHT_N, rel=0.03)
    world.follow(swing(world))


def test_a_leg_that_finds_no_ground_ends_the_run() -> None:
    world = world_of(legs=LegSettings(clearance_m=0.3))
    drive(world, 6.0)
    foot = world.model.geom("foot_1").id
    world.model.geom_contype[foot] = world.model.geom_conaffinity[foot] = 0
    with pytest.raises(RobotError, match="has found no ground"):
        wait(world, 20.0)


@pytest.mark.parametrize("stopped_s", [0.0, 2.0, 4.0, 6.0])
def test_a_resumed_machine_goes_on_with_its_legs_where_they_were(stopped_s: float) -> None:
    """On its wheels, while its legs are put down, while they settle, and where it stands."""
    world, other = world_of(), world_of()
    drive(world, 5.0)
    world.stop()
    wait(world, stopped_s)
    other.restore(world.keep())
    np.testing.assert_array_equal(other.legs.springs_m(), world.legs.springs_m())
    if stopped_s > 0.0:  # a process that has ended commands no longer, and the machine has braked
        wait(world, 1.0)
        wait(other, 1.0)
        np.testing.assert_array_equal(other.data.qpos, world.data.qpos)
    wait(other, 9.0)
    assert not other.is_moving
    assert other.legs.loads_n().sum() == pytest.approx(WEIGHT_N, rel=0.03)


def test_what_bears_the_machine_is_seen_by_the_truth_of_tipping_throughout() -> None:
    """The moment that holds it hardly changes on its way from legs to wheels and back."""
    world = world_of()
    reaction = GroundReaction(M545, world.model)
    shares = []
    world.observe(lambda world: shares.append(reaction.share(world.model, world.data)))
    drive(world, 8.0)
    wait(world, 7.0)
    assert max(shares[50:]) < 0.15


def test_a_machine_without_driving_has_no_wheels_to_stand_on() -> None:
    fixed = M545.model_copy(update={"driving": None})
    terrain = make_terrain(TerrainSettings(), np.random.default_rng(0))
    world = World(fixed, Site(terrain, (), ()), PhysicsSettings(), "nominal", LegSettings())
    with pytest.raises(RobotError, match="give driving in the machine's"):
        world.drive(AHEAD)
    world.give_up()
    world.take_up()
    assert not world.is_moving
