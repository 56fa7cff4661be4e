"""The tool of the simulated arm on planned motions, beside the place where it shall be."""

import runpy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.robot.mujoco.machine.hydraulic_arm import HydraulicArm
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.site.settings import SiteSettings
from executive_plugins.robot.mujoco.site.site import make_site
from executive_plugins.robot.mujoco.world import CONTROL_STEP_S, World

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.command import Follow
from executive.messages.request import MoveRequest
from executive.messages.trajectory import JointTrajectory

_SHARED = runpy.run_path(str(Path(__file__).parents[2] / "plugins" / "motion" / "conftest.py"))
_RING_M, _SIZE_M = (4.0, 7.0), 1.0  # of the stones, and their size
_LOAD_KG = (500.0, 1500.0)  # of the stones that are carried
_SETTLE_S = 1.0
RMS_MM, GOAL_MM = Bound(30.0, 15.0), Bound(20.0, 10.0)


@dataclass(frozen=True, slots=True)
class Tracked:
    """One motion.

    Attributes:
        load_kg: Mass in the gripper.
        rms_mm: Root of the mean square of the tool's distance from its place while it moves.
        worst_mm: The largest distance.
        goal_mm: Distance from the goal after it.
    """

    load_kg: float
    rms_mm: float
    worst_mm: float
    goal_mm: float


def measured(seeds: Sequence[int], most: int, is_hydraulic: bool) -> list[Tracked]:
    """Follow planned motions, with a machine of its own for each seed."""
    machine, planner = load_machine("m545"), _SHARED["started"]("m545")
    found: list[Tracked] = []
    for seed in seeds:
        rng = np.random.default_rng((seed, 1))
        world = _world(machine, rng, is_hydraulic)
        for trajectory, is_loaded in _motions(machine, planner, seed, most):
            load_kg = float(rng.uniform(*_LOAD_KG)) if is_loaded else 0.0
            found.append(_followed(world, trajectory, load_kg))
        print(f"seed {seed}: {_words(found)}", flush=True)
    return found


def _world(machine: Machine, rng: np.random.Generator, is_hydraulic: bool) -> World:
    settings = SiteSettings.model_validate({"stones": {"count": 0}})
    site = make_site(settings, machine, PhysicsSettings(), rng)
    world = World(machine, site, PhysicsSettings(), valves=rng if is_hydraulic else None)
    # The motions were planned above another ground.
    world.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    return world


def _motions(
    machine: Machine, planner: object, seed: int, most: int
) -> Iterator[tuple[JointTrajectory, bool]]:
    site = _SHARED["Site"](machine, _RING_M, _SIZE_M, seed)
    start, count = machine.posture("scan"), 0
    for stone in range(len(site.stones)):
        pick = site.pick(start, stone)
        there = planner.move(pick).trajectory
        if there is None:
            continue
        place: MoveRequest = site.place(there.position[-1], pick.T_map_gripper, stone)
        back = planner.move(place).trajectory
        for trajectory, is_loaded in ((there, False), (back, True)):
            if trajectory is not None and count < most:
                yield trajectory, is_loaded
                start, count = trajectory.position[-1], count + 1


def _followed(world: World, trajectory: JointTrajectory, load_kg: float) -> Tracked:
    """Follow a trajectory from its first posture, with a load at the grasp centre."""
    _load(world, load_kg)
    kinematics, centre = Kinematics(world.machine), world.machine.gripper.grasp_centre

    def tool(q: Float) -> Float:
        return np.asarray(transform(kinematics.gripper(q), centre))

    _stand(world)
    world.follow(Follow(trajectory))
    errors: list[float] = []
    goal = tool(trajectory.position[-1])
    while world.is_moving:
        world.step()
        errors.append(float(np.linalg.norm(tool(world.arm.position()) - tool(_due(world)))))
    _stand(world)
    away = float(np.linalg.norm(tool(world.arm.position()) - goal))
    squares = np.square(errors)
    return Tracked(load_kg, 1e3 * squares.mean() ** 0.5, 1e3 * max(errors), 1e3 * away)


def _stand(world: World) -> None:
    for _ in range(round(_SETTLE_S / CONTROL_STEP_S)):
        world.step()


def _due(world: World) -> Float:
    if isinstance(world.arm, HydraulicArm):
        return world.arm.controller.due()
    return world.reference()


def _load(world: World, load_kg: float) -> None:
    """Set the mass of a ball at the grasp centre, which is part of the palm here."""
    palm = world.model.body(world.machine.gripper_link).id
    own_kg = world.machine.links[world.machine.gripper_link].mass_kg
    own_m = np.array(world.machine.links[world.machine.gripper_link].com_m)
    centre = world.machine.gripper.grasp_centre
    world.model.body_mass[palm] = own_kg + load_kg
    world.model.body_ipos[palm] = (own_kg * own_m + load_kg * centre) / (own_kg + load_kg)
    # The drives carry the weight of the links and not that of the load.
    world.model.body_gravcomp[palm] = own_kg / (own_kg + load_kg)
    mujoco.mj_setConst(world.model, mujoco.MjData(world.model))


def figures(found: Sequence[Tracked]) -> list[Figure]:
    """Return the figures of the motions: the worst path decides, the median is told."""
    rms = np.array([one.rms_mm for one in found])
    goal = np.array([one.goal_mm for one in found])
    return [
        _held("tool tracking, rms of a path, worst path [mm]", rms, RMS_MM),
        _held("tool at the goal, worst path [mm]", goal, GOAL_MM),
        Figure("largest distance on a path [mm]", f"{max(one.worst_mm for one in found):.1f}"),
    ]


def _held(what: str, values: Float, bound: Bound) -> Figure:
    words = f"{values.max():.1f} (p50 {np.median(values):.1f}, {len(values)} paths)"
    return held(what, float(values.max()), bound, words)


def _words(found: Sequence[Tracked]) -> str:
    last = found[-1]
    return f"{len(found)} paths; {last.rms_mm:.1f} mm rms, {last.goal_mm:.1f} at the goal"
