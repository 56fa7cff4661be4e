"""The stones of a site: generated blocks, or scans from a folder."""

from pathlib import Path

import numpy as np
from executive_plugins.physics.quarried_block import block
from executive_plugins.robot.mujoco.site.mass_properties import volume_and_centroid
from executive_plugins.robot.mujoco.site.rough_skin import rough_skin
from executive_plugins.robot.mujoco.site.settings import StoneSettings
from executive_plugins.robot.mujoco.site.stone_meshes import mesh_files, read_skin
from executive_plugins.robot.mujoco.site.stone_model import StoneModel

from executive.errors import ConfigError


def make_stones(
    settings: StoneSettings, payload_kg: float, rng: np.random.Generator
) -> tuple[StoneModel, ...]:
    """Draw the stones of a site, `stone_1` first.

    Raises:
        ConfigError: If the folder has too few meshes that can be lifted, or an unusable file.
    """
    if settings.folder is None or settings.count == 0:
        return tuple(_generated(f"stone_{i + 1}", settings, rng) for i in range(settings.count))
    return _scanned(settings, settings.folder, settings.max_mass_kg or payload_kg, rng)


def _generated(name: str, settings: StoneSettings, rng: np.random.Generator) -> StoneModel:
    """Return a block with a smooth contact hull and a bumpy skin, both of the drawn volume."""
    volume_m3 = rng.uniform(*settings.volume_m3)
    corners = block(volume_m3, rng)
    vertices, triangles = rough_skin(corners, settings.roughness_m, settings.edge_m, rng)
    rough_m3, _ = volume_and_centroid(vertices, triangles)
    vertices *= np.cbrt(volume_m3 / rough_m3)  # bumps change the volume by a few per mille
    return StoneModel.from_skin(name, (vertices, triangles), settings.density_kg_m3, hull=corners)


def _scanned(
    settings: StoneSettings, folder: Path, max_mass_kg: float, rng: np.random.Generator
) -> tuple[StoneModel, ...]:
    """Draw meshes in random order without repetition; those that are too heavy are skipped."""
    files = mesh_files(folder)
    chosen: list[StoneModel] = []
    for i in rng.permutation(len(files)):
        if len(chosen) == settings.count:
            break
        skin = read_skin(files[i], settings.scale)
        stone = StoneModel.from_skin(f"stone_{len(chosen) + 1}", skin, settings.density_kg_m3)
        if stone.mass_kg <= max_mass_kg:
            chosen.append(stone)
    if len(chosen) < settings.count:
        raise ConfigError(
            f"robot.site.stones.folder: only {len(chosen)} of the {len(files)} meshes "
            f"of '{folder}' weigh at most "
            f"{max_mass_kg:.0f} kg at scale {settings.scale:g}; {settings.count} are wanted: "
            "lower stones.count or stones.scale"
        )
    return tuple(chosen)
