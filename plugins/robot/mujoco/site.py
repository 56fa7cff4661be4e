"""A site: rough ground, and stones that have come to rest on it."""

from dataclasses import dataclass

import mujoco
import numpy as np

from executive.arrays import Float
from executive.config import Settings
from plugins.robot.mujoco.physics import PhysicsSettings
from plugins.robot.mujoco.stone_model import StoneModel
from plugins.robot.mujoco.stone_placement import place
from plugins.robot.mujoco.stones import StoneSettings, make_stones
from plugins.robot.mujoco.terrain import Terrain, TerrainSettings, make_terrain
from robot_models.machine import Machine


class SiteSettings(Settings):
    """The ground and the stones."""

    terrain: TerrainSettings = TerrainSettings()
    stones: StoneSettings = StoneSettings()


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """What surrounds the machine when the mission begins.

    Attributes:
        terrain: The ground.
        stones: The stones, `stone_1` first; none is a site, too.
        T_world_stones: Where each lies at rest, (4, 4) each.
    """

    terrain: Terrain
    stones: tuple[StoneModel, ...]
    T_world_stones: tuple[Float, ...]

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Add ground and stones to a world."""
        self.terrain.add_to(spec)
        for stone, T_world_stone in zip(self.stones, self.T_world_stones, strict=True):
            stone.add_to(spec, T_world_stone)


def make_site(settings: SiteSettings, machine: Machine, physics: PhysicsSettings, rng: np.random.Generator) -> Site:
    """Draw a site; one generator state gives one site, bit for bit.

    Raises:
        ConfigError: If its stones cannot be read or do not fit; the message says what to change.
    """
    ground_rng, shape_rng, place_rng = rng.spawn(3)
    terrain = make_terrain(settings.terrain, ground_rng)
    stones = make_stones(settings.stones, machine.payload_kg, shape_rng)
    if not stones:
        return Site(terrain, (), ())
    poses = place(stones, terrain, settings.stones.placement, machine.reach_m, physics, place_rng)
    return Site(terrain, stones, poses)
