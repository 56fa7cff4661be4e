"""The machine on its legs: it stands level, sways, is felt by its sensors, and tips."""

from collections.abc import Sequence

import numpy as np
import pytest
from executive_plugins.physics.scenario import contact_of
from executive_plugins.robot.mujoco.machine.legs import legs_names
from executive_plugins.robot.mujoco.physics_settings import LegSettings, PhysicsSettings
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings
from executive_plugins.robot.mujoco.site.settings import (
    SiteSettings,
    StoneSettings,
    TerrainSettings,
)
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.terrain import make_terrain
from executive_plugins.robot.mujoco.truth.ground_reaction import GroundReaction
from executive_plugins.robot.mujoco.world import World

from executive.errors import ConfigError, RobotError
from executive.geometry.pose import pose, transform
from executive.machine.kinematics import Kinematics
from executive.machine.lean import Lean
from executive.machine.lift_capacity import Capacity, LiftCapacity
from executive.machine.loaded_stop import LoadedStop
from executive.machine.machine import Machine, load_machine
from executive.machine.sway import Sway
from executive.messages.command import Follow
from executive.messages.imu import ImuSample
from executive.messages.observation import Observation
from executive.messages.trajectory import JointTrajectory

GRAVITY_M_S2 = 9.81
# The gripper hangs at 6 m, its tips above the ground.
FAR = {"J_BOOM": 0.75, "J_DIPPER": 0.3, "J_TELE": 1.2, "J_EE_PITCH": -1.19}


def on_legs(machine: Machine, legs: LegSettings | None = None) -> World:
    terrain = make_terrain(TerrainSettings(undulation_m=0, roughness_m=0), np.random.default_rng(0))
    return World(
        machine, Site(terrain, (), ()), PhysicsSettings(), "nominal", legs or LegSettings()
    )


def path(machine: Machine, start: np.ndarray, goal: np.ndarray) -> JointTrajectory:
    u, duration_s = np.linspace(0, 1, 80), 6.0
    share, slope = 10 * u**3 - 15 * u**4 + 6 * u**5, (30 * u**2 - 60 * u**3 + 30 * u**4)
    return JointTrajectory(
        machine.arm_names,
        u * duration_s,
        start + np.outer(share, goal - start),
        np.outer(slope, goal - start) / duration_s,
    )


def sideways(machine: Machine) -> np.ndarray:
    """Return a posture with the gripper at the left."""
    posture = dict(zip(machine.arm_names, machine.posture("carry"), strict=True)) | FAR
    return np.array([*(posture | {machine.turn_joint: np.pi / 2}).values()])


@pytest.mark.parametrize("name", ["m545", "mini"])
def test_a_machine_stands_level_on_its_legs_which_bear_its_weight(name: str) -> None:
    machine = load_machine(name)
    world = on_legs(machine)
    for _ in range(50):
        world.step()
    weight_n = GRAVITY_M_S2 * sum(link.mass_kg for link in machine.links.values())
    assert world.legs is not None
    assert world.legs.tilt_rad() < np.radians(0.05)
    assert world.legs.loads_n().sum() == pytest.approx(weight_n, rel=0.03)  # the feet's own apart
    assert world.T_world_base[2, 3] == pytest.approx(machine.stance.base_height_m, abs=0.005)
    np.testing.assert_allclose(world.arm.position(), machine.posture("scan"), atol=1e-3)


def test_the_weight_of_the_links_acts_at_the_chassis_with_its_moment() -> None:
    """The force and its moment about the chassis are the sums over the links, one by one."""
    machine = load_machine("m545")
    world = on_legs(machine)
    assert world.legs is not None
    world.legs.weigh()
    base = world.data.body(machine.base_link)
    force, moment = np.zeros(3), np.zeros(3)
    for name in machine.links:
        weight = np.array([0.0, 0.0, -GRAVITY_M_S2 * world.model.body(name).mass[0]])
        force += weight
        moment += np.cross(world.data.body(name).xipos - base.xipos, weight)
    np.testing.assert_allclose(base.xfrc_applied[:3], force, rtol=1e-9)
    np.testing.assert_allclose(base.xfrc_applied[3:], moment, rtol=1e-9, atol=1e-6)


@pytest.fixture(scope="module")
def reached() -> tuple[World, Capacity, dict]:
    """A machine that has swung to its side, the lift capacity there, and its state."""
    machine = load_machine("m545")
    world = on_legs(machine)
    world.follow(Follow(path(machine, world.arm.position(), sideways(machine))))
    for _ in range(800):
        world.step()
    return world, LiftCapacity(machine).at(world.arm.position()), dict(world.keep())


def test_it_leans_with_its_arm_as_plans_foretell(reached: tuple) -> None:
    """The tips end 5 cm lower at 6 m than on a level machine, and 1 cm from where they should."""
    world, _, kept = reached
    world.restore(kept)
    world.step()
    machine, q = world.machine, world.arm.position()
    settings = MujocoSettings(base="on_legs")
    stance = machine.stance.model_copy(update={"support_n_m": settings.support_n_m})
    lean = Lean(machine.model_copy(update={"stance": stance}))
    T_level = pose(t=np.array([0.0, 0.0, machine.stance.base_height_m]))
    foretold = lean.moved(T_level, machine.posture("scan"), q)
    base, tool = world.data.body(machine.base_link), Kinematics(machine).gripper(q)[:3, 3]
    T_leaning = pose(base.xmat.reshape(3, 3), base.xpos)
    level, seen, told = (transform(T, tool) for T in (T_level, T_leaning, foretold))
    assert level[2] - seen[2] > 0.04
    np.testing.assert_allclose(told, seen, atol=0.01)


def hang(world: World, mass_kg: float, grown_s: float = 2.0, lasting_s: float = 6.0) -> None:
    """Let a load pull at the grasp centre, ever heavier for 2 s, then for 4 s more."""
    gripper = world.data.body(world.machine.gripper_link)
    for step in range(round(100 * lasting_s)):
        at = gripper.xpos + gripper.xmat.reshape(3, 3) @ world.machine.gripper.grasp_centre
        share = min(1.0, step / (100 * grown_s)) if grown_s else 1.0
        weight = np.array([0.0, 0.0, -GRAVITY_M_S2 * mass_kg * share])
        gripper.xfrc_applied[:3] = weight
        gripper.xfrc_applied[3:] = np.cross(at - gripper.xipos, weight)
        world.step()


def test_it_carries_its_rated_load_at_the_side_and_leans(reached: tuple) -> None:
    world, capacity, kept = reached
    world.restore(kept)
    before_rad = world.legs.tilt_rad()
    hang(world, capacity.rated_kg)
    assert capacity.radius_m == pytest.approx(6.0, abs=0.3)
    assert world.legs.tilt_rad() > before_rad + np.radians(0.1)
    assert 0.0 < world.legs.margin_m() < 0.5


def test_it_leans_with_a_load_as_plans_foretell(reached: tuple) -> None:
    """The load swings from the side to the front; without its mass the lean is another one."""
    world, capacity, kept = reached
    world.restore(kept)
    machine, q_side = world.machine, world.arm.position()
    hang(world, capacity.rated_kg)
    base = world.data.body(machine.base_link)
    T_side = pose(base.xmat.reshape(3, 3), base.xpos)
    front = dict(zip(machine.arm_names, q_side, strict=True)) | {machine.turn_joint: 0.0}
    world.follow(Follow(path(machine, q_side, np.array([*front.values()]))))
    hang(world, capacity.rated_kg, grown_s=0.0, lasting_s=10.0)
    q = world.arm.position()
    support_n_m = MujocoSettings(base="on_legs").support_n_m
    stance = machine.stance.model_copy(update={"support_n_m": support_n_m})
    lean = Lean(machine.model_copy(update={"stance": stance}))
    tool = Kinematics(machine).gripper(q)[:3, 3]
    seen = transform(pose(base.xmat.reshape(3, 3), base.xpos), tool)
    told, without = (
        transform(lean.moved(T_side, q_side, q, load_kg), tool)
        for load_kg in (capacity.rated_kg, 0.0)
    )
    np.testing.assert_allclose(told, seen, atol=0.01)
    assert np.abs(without - seen).max() > 0.015


def test_it_tips_with_a_little_more_than_balances_it(reached: tuple) -> None:
    """1.3 t at 6 m; the capacity, which the planners refuse it by, is computed without the
    simulator.
    """
    world, capacity, kept = reached
    world.restore(kept)
    assert capacity.refusal(1300.0)
    with pytest.raises(RobotError, match="tipped over"):
        hang(world, 1.08 * capacity.tipping_kg)
    assert world.legs.most_tilt_rad > np.radians(5.0)
    assert world.legs.least_margin_m < 0.05


def test_the_chassis_inertial_sensor_feels_how_far_the_machine_leans() -> None:
    machine = load_machine("m545")
    empty = SiteSettings(stones=StoneSettings(count=0))
    settings = MujocoSettings(base="on_legs", site=empty)
    robot = MujocoRobot(settings, machine, np.random.default_rng(3))
    robot.start()
    level = chassis_up(robot.read(0.5))
    goal = sideways(machine)
    robot.command(Follow(path(machine, robot.world.arm.position(), goal)))
    robot.read(7.5)
    leaning = chassis_up(robot.read(8.0))
    assert robot.world.legs is not None
    tilt_rad = robot.world.legs.tilt_rad()
    assert tilt_rad > np.radians(0.4)
    assert np.arccos(level @ leaning) == pytest.approx(tilt_rad, abs=np.radians(0.1))


def chassis_up(seen: Sequence[Observation]) -> np.ndarray:
    """Return the mean direction of the specific force at the chassis, shape (3,)."""
    forces = [o.specific_force_m_s2 for o in seen if isinstance(o, ImuSample)]
    frames = [o.frame for o in seen if isinstance(o, ImuSample)]
    mean = np.mean([f for f, name in zip(forces, frames, strict=True) if name == "imu_base"], 0)
    return np.asarray(mean / np.linalg.norm(mean))


def test_a_machine_without_points_of_support_is_refused_with_the_cure() -> None:
    machine = load_machine("m545")
    stance = machine.stance.model_copy(update={"supports_m": ()})
    bare = machine.model_copy(update={"stance": stance})
    with pytest.raises(ConfigError, match="supports_m"):
        on_legs(bare)
    refusals = list(MujocoSettings(base="on_legs").refusals(bare))
    assert [refusal.setting for refusal in refusals] == [("base",)]


def test_each_foot_stands_at_its_point_of_support_as_wide_as_a_tyre_and_digs_into_the_soil() -> (
    None
):
    """Its friction is the soil's, and turns it by that of an even round patch as wide as it is."""
    machine = load_machine("m545")
    world = on_legs(machine)
    model, data = world.model, world.data
    base = data.body(machine.base_link)
    soil = contact_of("nominal", machine.gripper).soil
    total_kg = sum(link.mass_kg for link in machine.links.values())
    assert model.body_mass.sum() == pytest.approx(total_kg, rel=1e-3)  # the feet's is taken away
    for name, support_m in zip(legs_names(machine), machine.stance.supports_m, strict=True):
        foot, radius_m = model.geom(name), float(model.geom(name).size[0])
        assert 0.1 < radius_m < 0.25  # half the width of a tyre
        bottom = data.geom(name).xpos - [0, 0, radius_m] - base.xpos
        np.testing.assert_allclose(bottom[:2], support_m, atol=1e-3)
        assert bottom[2] == pytest.approx(-machine.stance.base_height_m, abs=0.01)
        assert foot.friction[0] == pytest.approx(soil.friction)
        assert foot.friction[1] == pytest.approx(2 / 3 * soil.friction * radius_m)
        assert foot.condim[0] == 4
        others = np.delete(model.geom_priority, [model.geom(n).id for n in legs_names(machine)])
        assert foot.priority[0] > others.max()
        low, high = model.joint(name).range
        assert low < -0.2
        assert high > 0.2
        speed = 2 * LegSettings().damping_ratio
        speed *= np.sqrt(LegSettings().stiffness_n_m * total_kg / len(machine.stance.supports_m))
        assert model.dof_damping[model.joint(name).dofadr[0]] == pytest.approx(speed)


def test_legs_that_bear_nothing_have_no_margin_and_others_that_of_their_resultant() -> None:
    """Of all load on one foot, the resultant is on the rim of the area of support."""
    machine = load_machine("m545")
    world = on_legs(machine)
    legs, model = world.legs, world.model
    spring = [model.joint(name).qposadr[0] for name in legs_names(machine)]
    world.data.qpos[spring] = model.qpos_spring[spring] - 0.01
    assert legs.loads_n().tolist() == [0.0] * len(spring)
    assert legs.margin_m() == 0.0
    world.data.qpos[spring] = model.qpos_spring[spring] + 0.01
    assert legs.loads_n().min() > 0.0
    assert legs.margin_m() > 0.5
    world.data.qpos[spring[1:]] = model.qpos_spring[spring[1:]] - 0.01
    assert legs.margin_m() == pytest.approx(0.0, abs=1e-9)


def laden(machine: Machine, load_kg: float) -> Machine:
    """Return a machine on its legs with a load in the palm of its gripper."""
    gripper = machine.gripper
    mass_kg = gripper.palm_mass_kg + load_kg
    middle = gripper.palm_mass_kg * np.array(gripper.palm_com_m) + load_kg * gripper.grasp_centre
    told = machine.model_dump(exclude_unset=True)
    told["gripper"] |= {"palm_mass_kg": mass_kg, "palm_com_m": tuple(map(float, middle / mass_kg))}
    told["stance"] |= {"support_n_m": LegSettings().stiffness_n_m, "is_free": True}
    return Machine.model_validate(told)


def turned(machine: Machine, azimuth_rad: float) -> np.ndarray:
    """Return a posture with the gripper hanging at 5 m."""
    posture = dict(zip(machine.arm_names, machine.posture("carry"), strict=True))
    posture |= {"J_BOOM": 1.05, "J_DIPPER": 0.0, "J_TELE": 0.9, machine.turn_joint: azimuth_rad}
    return np.array([*posture.values()])


@pytest.mark.parametrize(("azimuth_rad", "load_kg"), [(0.0, 800.0), (0.79, 1800.0)])
def test_it_sways_with_the_period_that_plans_reckon_with(
    azimuth_rad: float, load_kg: float
) -> None:
    """Above a corner, too, where the leg across is in the air; the kick is that of 5 cm/s."""
    machine = laden(load_machine("m545"), load_kg)
    world = on_legs(machine)
    world.follow(Follow(path(machine, world.arm.position(), turned(machine, azimuth_rad))))
    for _ in range(1000):
        world.step()
    gripper, heights_m = world.data.body(machine.gripper_link), []
    for step in range(400):
        gripper.xfrc_applied[2] = -0.5 * (load_kg + 1000.0) if step < 10 else 0.0
        world.step()
        heights_m.append(float(gripper.xpos[2]))
    turns = np.flatnonzero(np.diff(np.sign(np.diff(heights_m[10:]))))
    period_s = 2 * 0.01 * float(np.diff(turns[:5]).mean())
    foretold_s = Sway(machine).period_s(world.arm.position(), 0.0)
    assert foretold_s == pytest.approx(period_s, rel=0.1)


def tipping(load_kg: float, stop_s: float) -> float:
    """Return the largest share of tipping after a stop in the middle of a swing."""
    machine = laden(load_machine("m545"), load_kg)
    world = on_legs(machine)
    q = turned(machine, np.pi / 2)
    world.follow(Follow(path(machine, world.arm.position(), q)))
    for _ in range(900):
        world.step()
    lower = q + np.array([0.0, -0.4, 0.0, 0.0, 0.0, 0.0, 0.0])
    half = path(machine, world.arm.position(), lower)
    down = JointTrajectory(half.names, half.times_s / 2, half.position, 2 * half.velocity)
    world.follow(Follow(down, stop_s))
    for _ in range(120):
        world.step()
    world.stop()
    reaction, most = GroundReaction(machine, world.model), 0.0
    for _ in range(250):
        world.step()
        most = max(most, reaction.share(world.model, world.data))
    return most


def test_a_stop_that_spares_the_machine_tips_it_less_than_a_quick_one() -> None:
    """The gripper is stopped on its way down, at 0.8 m/s, with 0.6 t at the side."""
    machine, load_kg = laden(load_machine("m545"), 600.0), 600.0
    q = turned(machine, np.pi / 2)
    down = path(machine, q, q - 0.4 * np.eye(7)[1])
    stop_s = LoadedStop(machine).least_s(down.position, 2 * down.velocity, 0.0)
    assert 0.7 < stop_s < 1.5
    assert tipping(load_kg, stop_s) < 0.8 * tipping(load_kg, 0.0)
