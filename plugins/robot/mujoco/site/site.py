"""A site: rough ground, what stands on it, and stones that rest on it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from executive_plugins.physics.scenario import Scenario, contact_of
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.site.obstacle import Obstacle, make_obstacles
from executive_plugins.robot.mujoco.site.person import Person, make_people
from executive_plugins.robot.mujoco.site.settings import SiteSettings, StoneSettings
from executive_plugins.robot.mujoco.site.stone_model import StoneModel
from executive_plugins.robot.mujoco.site.stone_placement import Grounds, footprint, place
from executive_plugins.robot.mujoco.site.stones import make_stones
from executive_plugins.robot.mujoco.site.terrain import Terrain, make_terrain

from executive.arrays import Float
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import Machine

# Share by which the density of a stone differs from the mean at most. Granite, gneiss and limestone
# of one quarry differ by some 4 %, a mixture of found stones by 15 % (2,300 to 3,100 kg/m³).
_DENSITY_SPREAD: Mapping[Scenario, float] = {
    "kind": 0.0,
    "nominal": 0.04,
    "wet": 0.04,
    "harsh": 0.15,
}


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """The surroundings of the machine when the mission begins.

    Attributes:
        terrain: The ground.
        stones: The stones, `stone_1` first; may be empty.
        T_world_stones: Pose of each stone at rest, (4, 4) each.
        obstacles: What stands on the ground and never moves.
        people: Who walks on it.
    """

    terrain: Terrain
    stones: tuple[StoneModel, ...]
    T_world_stones: tuple[Float, ...]
    obstacles: tuple[Obstacle, ...] = ()
    people: tuple[Person, ...] = ()

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add ground, obstacles, stones, people and daylight to a world."""
        add_daylight(spec)
        self.terrain.add_to(spec)
        for obstacle in self.obstacles:
            obstacle.add_to(spec)
        for stone, T_world_stone in zip(self.stones, self.T_world_stones, strict=True):
            stone.add_to(spec, T_world_stone)
        for person in self.people:
            person.add_to(spec)


def make_site(
    settings: SiteSettings,
    machine: Machine,
    physics: PhysicsSettings,
    rng: np.random.Generator,
    scenario: Scenario = "kind",
) -> Site:
    """Draw a site; equal generator states give identical sites.

    Raises:
        ConfigError: If its stones cannot be read or do not fit; the message says what to change.
    """
    ground_rng, shape_rng, place_rng, density_rng = rng.spawn(4)
    terrain = make_terrain(settings.terrain, ground_rng)
    obstacles = make_obstacles(settings.obstacles, terrain)
    people = make_people(settings.people, terrain)
    densities = _densities(scenario, settings.stones, density_rng)
    stones = make_stones(settings.stones, machine.payload_kg, shape_rng, densities)
    if not stones:
        return Site(terrain, (), (), obstacles, people)
    is_liftable = settings.liftable
    if is_liftable is None:
        is_liftable = scenario != "kind" or machine.stance.is_free
    capacity = LiftCapacity(machine) if is_liftable else None
    contact = contact_of(scenario, machine.gripper)
    grounds = Grounds(
        terrain,
        settings.stones.placement,
        machine.reach_m,
        capacity,
        taken=tuple(footprint(obstacle.mesh()[0]) for obstacle in obstacles),
    )
    poses = place(stones, grounds, physics, contact, place_rng)
    return Site(terrain, stones, poses, obstacles, people)


def _densities(
    scenario: Scenario, settings: StoneSettings, rng: np.random.Generator
) -> Sequence[float]:
    """Draw the density of each stone [kg/m³]; none where all are alike."""
    spread = _DENSITY_SPREAD[scenario]
    if spread == 0.0:
        return ()
    return [
        float(d)
        for d in settings.density_kg_m3 * rng.uniform(1 - spread, 1 + spread, settings.count)
    ]


def add_daylight(spec: mujoco.MjSpec) -> None:
    """Add a sun and a sky, for pictures only."""
    spec.worldbody.add_light(
        name="sun",
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=[0.0, 0.0, 30.0],
        dir=[-0.5, 0.35, -0.8],
        diffuse=[0.75, 0.72, 0.66],
        castshadow=True,
    )
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.55, 0.7, 0.9],
        rgb2=[0.9, 0.93, 0.96],
        width=256,
        height=1536,
    )
