"""What a world is told in mid-motion: to stop for good, to wait, to drive, to go on as it was."""

import numpy as np
import pytest
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.site.settings import TerrainSettings
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.terrain import make_terrain
from executive_plugins.robot.mujoco.world import World

from executive.arrays import Float
from executive.errors import RobotError
from executive.machine.machine import load_machine
from executive.messages.command import Drive, Follow, MoveJaws
from executive.testing.exercises.robot import turn

M545 = load_machine("m545")
STEP_S = 0.01
LEVEL = make_terrain(TerrainSettings(undulation_m=0, roughness_m=0), np.random.default_rng(0))
SPEED_M_S, CURVATURE_1_M = 0.4, 0.1
TURN = M545.arm_names.index(M545.turn_joint)


def world_of(*, on_wheels: bool = False, on_cylinders: bool = False) -> World:
    valves = np.random.default_rng(7) if on_cylinders else None
    settings = PhysicsSettings()
    return World(M545, Site(LEVEL, (), ()), settings, valves=valves, on_wheels=on_wheels)


def swung(angle_rad: float = 0.3, duration_s: float = 2.0, **kind: bool) -> World:
    """Return a world in which the cabin has swung for 0.3 s."""
    world = world_of(**kind)
    start = world.arm.position()
    world.follow(Follow(turn(M545.arm_names, M545.turn_joint, start, angle_rad, duration_s)))
    run(world, 0.3)
    return world


def run(world: World, duration_s: float) -> Float:
    """Step, and return the place of the base after it [m], shape (3,)."""
    for _ in range(round(duration_s / STEP_S)):
        world.step()
    return np.asarray(world.T_world_body(M545.base_link)[:3, 3])


def test_a_machine_that_gives_up_slows_down_and_does_not_resume() -> None:
    world = swung()
    assert world.is_moving
    before = world.reference()[TURN]
    world.give_up()
    run(world, 0.5)
    assert not world.is_moving
    stood = world.reference()[TURN]
    assert before < stood < 0.15
    world.resume()
    run(world, 0.3)
    assert not world.is_moving
    assert world.reference()[TURN] == stood


def test_jaws_that_move_freely_hold_when_the_machine_gives_up() -> None:
    world = world_of()
    for one in (world, other := world_of()):
        one.move_jaws(MoveJaws(M545.jaw.upper, 5e3))
        run(one, 0.3)
    world.give_up()
    before = world.jaws.position_rad
    run(world, 0.5)
    run(other, 0.5)
    assert world.jaws.position_rad == pytest.approx(before, abs=0.02)
    assert abs(other.jaws.position_rad - before) > 0.1


def test_a_pause_takes_no_time_of_the_path_and_jaws_go_on_after_it() -> None:
    """After it the arm is as far as the mission's time, but for what `behind_s` says."""
    world, alone = swung(), swung()
    for one in (world, alone):
        one.move_jaws(MoveJaws(M545.jaw.upper, 5e3))
        run(one, 0.2)
    world.pause()
    world.stop()
    jaws = world.jaws.position_rad
    run(world, 1.0)
    assert world.jaws.position_rad == pytest.approx(jaws, abs=0.02)
    assert not world.is_moving
    behind_s = world.behind_s()
    assert 0.0 <= behind_s < 0.15  # speeding up takes more time than braking has gained
    world.go_on()
    world.resume()
    run(alone, 1.0 - round(behind_s, 2))
    run(world, 1.0)
    assert world.jaws.position_rad > jaws + 0.1
    assert world.reference()[TURN] == pytest.approx(alone.reference()[TURN], abs=2e-3)


def test_an_arm_that_stands_while_time_goes_on_falls_behind_by_that_time() -> None:
    world = swung()
    assert world.behind_s() == pytest.approx(0.0, abs=1e-6)
    world.stop()
    run(world, 1.0)
    assert world.behind_s() == pytest.approx(1.0, abs=0.2)


def test_wheels_take_the_machine_along_and_brake_when_told_to() -> None:
    world = world_of(on_wheels=True)
    at_start = run(world, 0.1)
    world.drive(Drive(SPEED_M_S, 0.0))
    assert world.is_moving
    run(world, 0.1)
    driver = world.wheels.driver
    base = world.T_world_body(M545.base_link)
    np.testing.assert_allclose(base[:2, 3] - at_start[:2], driver.pose_map[:2], atol=2e-3)
    assert driver.pose_map[0] > 0.0
    with pytest.raises(RobotError, match="the chassis moves"):
        world.follow(Follow(turn(M545.arm_names, M545.turn_joint, world.arm.position(), 0.1, 2.0)))
    world.stop()
    way_m = driver.pose_map[0]
    run(world, 1.0)
    assert not world.is_moving
    limit = M545.driving.max_acceleration_m_s2
    assert driver.pose_map[0] < way_m + SPEED_M_S**2 / limit


def test_wheels_do_not_roll_while_the_arm_moves() -> None:
    world = swung(on_wheels=True)
    with pytest.raises(RobotError, match="the arm moves"):
        world.drive(Drive(SPEED_M_S, 0.0))


def test_a_machine_that_gives_up_on_its_wheels_brakes() -> None:
    world = world_of(on_wheels=True)
    world.drive(Drive(SPEED_M_S, 0.0))
    run(world, 0.2)
    world.give_up()
    run(world, 0.3)
    assert not world.is_moving


def test_a_resumed_machine_stands_where_its_wheels_had_taken_it() -> None:
    world, other = world_of(on_wheels=True), world_of(on_wheels=True)
    world.drive(Drive(SPEED_M_S, CURVATURE_1_M))
    run(world, 0.3)
    other.restore(world.keep())
    np.testing.assert_array_equal(other.wheels.driver.pose_map, world.wheels.driver.pose_map)
    np.testing.assert_array_equal(
        other.T_world_body(M545.base_link), world.T_world_body(M545.base_link)
    )
    assert other.time_s == world.time_s == pytest.approx(0.3)
    assert not other.is_moving  # the last command was to another process


def test_an_arm_on_cylinders_goes_on_bit_for_bit_from_a_kept_state() -> None:
    world = swung(on_cylinders=True)
    other = world_of(on_cylinders=True)
    other.restore(world.keep())
    for one in (world, other):
        run(one, 0.1)
    np.testing.assert_array_equal(other.arm.position(), world.arm.position())
    assert other.arm.position()[TURN] > 0.0


def test_joints_on_cylinders_have_dry_friction_and_others_have_none() -> None:
    joint = M545.arm_names[1]
    share = M545.hydraulics.friction
    loss = world_of(on_cylinders=True).model.joint(joint)
    dof = int(loss.dofadr[0])
    model = world_of(on_cylinders=True).model
    assert model.dof_frictionloss[dof] == pytest.approx(share * M545.joints[1].max_effort)
    assert world_of().model.dof_frictionloss[dof] == 0.0


def test_a_path_that_asks_for_more_oil_than_the_pump_gives_is_slowed_down() -> None:
    """The controller's share of the pump's flow, over what all joints together ask for."""
    world = world_of(on_cylinders=True)
    slow, fast = 0.1 * M545.max_velocity, 3.0 * M545.max_velocity
    flow = M545.hydraulics
    asked = sum(
        flow.displacement[name] * speed for name, speed in zip(M545.arm_names, fast, strict=True)
    )
    assert world.arm.pace(slow) == 1.0
    pace = world.arm.pace(fast)
    assert 0.8 * flow.pump_flow_m3_s < pace * asked <= flow.pump_flow_m3_s
    assert world.arm.pace(-fast) == pace


@pytest.mark.parametrize(("share", "sinks"), [(1.0, False), (0.02, True)])
def test_a_joint_with_a_small_share_of_its_effort_sinks_under_the_arm(
    share: float, sinks: bool
) -> None:
    """The boom carries the weight of all that is ahead of it."""
    world = world_of()
    boom = 1
    begin = world.arm.position()[boom]
    world.arm.weaken(M545.arm_names[boom], share)
    run(world, 0.5)
    assert bool(abs(world.arm.position()[boom] - begin) > 0.02) is sinks
    most = share * M545.joints[boom].max_effort
    assert abs(world.arm.effort()[boom]) <= 1.001 * most
    world.arm.weaken(M545.arm_names[boom], 1.0)
    run(world, 1.5)
    assert world.arm.position()[boom] == pytest.approx(begin, abs=0.05)
