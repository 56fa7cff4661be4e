"""A site: rough ground, and stones that rest on it."""

from dataclasses import dataclass

import mujoco
import numpy as np
from executive_plugins.physics.scenario import Scenario, contact_of
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.site.settings import (
    SiteSettings,
)
from executive_plugins.robot.mujoco.site.stone_model import StoneModel
from executive_plugins.robot.mujoco.site.stone_placement import place
from executive_plugins.robot.mujoco.site.stones import make_stones
from executive_plugins.robot.mujoco.site.terrain import Terrain, make_terrain

from executive.arrays import Float
from executive.machine.machine import Machine


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """The surroundings of the machine when the mission begins.

    Attributes:
        terrain: The ground.
        stones: The stones, `stone_1` first; may be empty.
        T_world_stones: Pose of each stone at rest, (4, 4) each.
    """

    terrain: Terrain
    stones: tuple[StoneModel, ...]
    T_world_stones: tuple[Float, ...]

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add ground, stones and daylight to a world."""
        add_daylight(spec)
        self.terrain.add_to(spec)
        for stone, T_world_stone in zip(self.stones, self.T_world_stones, strict=True):
            stone.add_to(spec, T_world_stone)


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
    ground_rng, shape_rng, place_rng = rng.spawn(3)
    terrain = make_terrain(settings.terrain, ground_rng)
    stones = make_stones(settings.stones, machine.payload_kg, shape_rng)
    if not stones:
        return Site(terrain, (), ())
    contact = contact_of(scenario, machine.gripper)
    where = settings.stones.placement
    poses = place(stones, terrain, where, machine.reach_m, physics, contact, place_rng)
    return Site(terrain, stones, poses)


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
