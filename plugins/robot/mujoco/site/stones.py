"""The stones of a site: generated blocks, or scans from a folder."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from executive_plugins.physics.quarried_block import block
from executive_plugins.robot.mujoco.site.rough_skin import rough_skin
from executive_plugins.robot.mujoco.site.settings import StoneSettings
from executive_plugins.robot.mujoco.site.stone_meshes import mesh_files, read_skin
from executive_plugins.robot.mujoco.site.stone_model import StoneModel

from executive.errors import ConfigError
from executive.geometry.solid import volume_and_centroid


def make_stones(
    settings: StoneSettings,
    payload_kg: float,
    rng: np.random.Generator,
    densities_kg_m3: Sequence[float] = (),
) -> tuple[StoneModel, ...]:
    """Draw the stones of a site, `stone_1` first.

    Args:
        settings: Which stones.
        payload_kg: Largest mass of scans whose largest mass is not given, and of generated stones
            whose volume is not given.
        rng: Random generator of shapes.
        densities_kg_m3: Density of each stone; that of the settings if empty.

    Raises:
        ConfigError: If the folder has too few meshes that can be lifted, or an unusable file.
    """
    densities = densities_kg_m3 or [settings.density_kg_m3] * settings.count
    if settings.count == 0:
        return ()
    if settings.folder is None:
        volumes_m3 = settings.volumes_m3(payload_kg * settings.density_kg_m3 / max(densities))
        return tuple(
            _generated(f"stone_{i + 1}", settings, volumes_m3, density, rng)
            for i, density in enumerate(densities)
        )
    most_kg = settings.max_mass_kg or payload_kg
    return _scanned(settings, settings.folder, most_kg, densities, rng)


def _generated(
    name: str,
    settings: StoneSettings,
    volumes_m3: tuple[float, float],
    density_kg_m3: float,
    rng: np.random.Generator,
) -> StoneModel:
    """Return a block with a smooth contact hull and a bumpy skin, both of the drawn volume."""
    volume_m3 = rng.uniform(*volumes_m3)
    corners = block(volume_m3, rng)
    vertices, triangles = rough_skin(corners, settings.roughness_m, settings.edge_m, rng)
    rough_m3, _ = volume_and_centroid(vertices, triangles)
    vertices *= np.cbrt(volume_m3 / rough_m3)  # bumps change the volume by a few per mille
    return StoneModel.from_skin(name, (vertices, triangles), density_kg_m3, hull=corners)


def _scanned(
    settings: StoneSettings,
    folder: Path,
    max_mass_kg: float,
    densities_kg_m3: Sequence[float],
    rng: np.random.Generator,
) -> tuple[StoneModel, ...]:
    """Draw meshes in random order without repetition; those that are too heavy are skipped.

    All meshes are read, so that one that is unusable is refused whatever the seed.
    """
    files = mesh_files(folder)
    skins = [read_skin(file, settings.scale) for file in files]
    chosen: list[StoneModel] = []
    for i in rng.permutation(len(files)):
        if len(chosen) == settings.count:
            break
        name, density_kg_m3 = f"stone_{len(chosen) + 1}", densities_kg_m3[len(chosen)]
        stone = StoneModel.from_skin(name, skins[i], density_kg_m3)
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
