"""The stones of a site: generated blocks, or scans from a folder."""

from pathlib import Path

import numpy as np
from executive_plugins.physics.quarried_block import block
from executive_plugins.robot.mujoco.site.mass_properties import volume_and_centroid
from executive_plugins.robot.mujoco.site.rough_skin import rough_skin
from executive_plugins.robot.mujoco.site.stone_meshes import mesh_files, read_skin
from executive_plugins.robot.mujoco.site.stone_model import StoneModel
from pydantic import Field, model_validator

from executive.config import Kilograms, KilogramsPerCubicMeter, Meters, Radians, Settings
from executive.errors import ConfigError


class PlacementSettings(Settings):
    """Where stones lie: a sector of an annulus around the turning axis."""

    min_radius_m: Meters | None = Field(
        None, ge=0, le=100, description="Nearest centroid [m]; 0.45 of the reach if not given."
    )
    max_radius_m: Meters | None = Field(
        None, ge=0, le=100, description="Farthest centroid [m]; 0.75 of the reach if not given."
    )
    sector_centre_rad: Radians = Field(
        0.0, ge=-3.2, le=3.2, description="Middle of the sector, from x [rad]."
    )
    sector_width_rad: Radians = Field(
        2.8,
        gt=0,
        le=6.2832,
        description="Width of the sector; the rest remains free for slots [rad].",
    )
    gap_m: Meters = Field(
        0.4, ge=0, le=10, description="Least free distance between two stones [m]."
    )


class StoneSettings(Settings):
    """Number, kind and placement of the stones."""

    count: int = Field(7, ge=0, le=200, description="Number of stones.")
    folder: Path | None = Field(
        None, description="Folder of closed meshes; generated blocks if not given."
    )
    scale: float = Field(1.0, gt=0, le=1000, description="Factor on the meshes of the folder.")
    density_kg_m3: KilogramsPerCubicMeter = Field(
        2700.0, ge=100, le=20000, description="Density [kg/m³]."
    )
    volume_m3: tuple[float, float] = Field(
        (0.5, 1.0), description="Least and largest generated volume [m³]."
    )
    max_mass_kg: Kilograms | None = Field(
        None,
        gt=0,
        description="Largest mass of a mesh of the folder [kg]; the payload if not given.",
    )
    roughness_m: Meters = Field(
        0.008, ge=0, le=0.1, description="Standard deviation of generated bumps [m]."
    )
    edge_m: Meters = Field(
        0.12, ge=0.03, le=1, description="Size of generated bumps: edge of the skin's mesh [m]."
    )
    placement: PlacementSettings = Field(
        PlacementSettings(), description="Where the stones may lie."
    )

    @model_validator(mode="after")
    def _check_volume(self) -> "StoneSettings":
        least, most = self.volume_m3
        if not 0.001 <= least <= most <= 20:
            raise ValueError(
                f"volume_m3 is [least, most] within 0.001 to 20 m³, got {list(self.volume_m3)}"
            )
        return self


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
