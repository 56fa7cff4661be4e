"""Settings of the robot plugins, apart from them: reading a mission imports no algorithm."""

from itertools import pairwise
from pathlib import Path
from typing import Literal

from pydantic import Field, model_validator

from executive.config import (
    Kilograms,
    KilogramsPerCubicMeter,
    Meters,
    MetersPerSecond,
    Radians,
    Settings,
)

_VOLUME_M3 = (0.5, 1.0)  # of the stones of Mascaro 2020: 1.35 to 2.7 t


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
    stations_m: tuple[tuple[Meters, Meters], ...] = Field(
        ((0.0, 0.0),),
        min_length=1,
        max_length=20,
        description="Places (x, y), each the middle of such a sector; stones are dealt out to "
        "them in turn [m].",
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
    volume_m3: tuple[float, float] | None = Field(
        None,
        description="Least and largest generated volume [m³]; if not given 0.5 to 1.0, or in "
        "proportion less for a machine whose payload is less.",
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
        if self.volume_m3 is None:
            return self
        least, most = self.volume_m3
        if not 0.001 <= least <= most <= 20:
            raise ValueError(
                f"volume_m3 is [least, most] within 0.001 to 20 m³, got {list(self.volume_m3)}"
            )
        return self

    def volumes_m3(self, most_kg: float) -> tuple[float, float]:
        """Return the range of generated volumes for a machine that lifts a mass [kg]."""
        if self.volume_m3 is not None:
            return self.volume_m3
        least, most = _VOLUME_M3
        share = min(1.0, most_kg / (most * self.density_kg_m3))
        return share * least, share * most


class TerrainSettings(Settings):
    """The shape of the ground."""

    half_size_m: Meters = Field(
        15.0, gt=2, le=100, description="Half the side of the square of ground [m]."
    )
    cell_m: Meters = Field(
        0.2, ge=0.1, le=1, description="Cell of the height field [m]; 0.1 m runs 8 times slower."
    )
    undulation_m: Meters = Field(
        0.04, ge=0, le=1, description="Standard deviation of the gentle waves [m]."
    )
    wavelength_m: Meters = Field(
        6.0, ge=1, le=50, description="Typical length of the gentle waves [m]."
    )
    roughness_m: Meters = Field(
        0.012, ge=0, le=0.3, description="Standard deviation of ruts and clods [m]."
    )
    pad_radius_m: Meters = Field(
        2.8, ge=0, le=20, description="Radius of the level pad about the machine [m]."
    )
    slope_rad: Radians = Field(
        0.0, ge=0, le=0.5, description="Slope of the ground around the level pad [rad]."
    )
    uphill_rad: Radians = Field(
        0.0, ge=-3.2, le=3.2, description="Direction in which the ground rises, from x [rad]."
    )
    loose_m: Meters = Field(
        0.15,
        ge=0,
        le=0.5,
        description="Depth of the loose soil, which the jaws' teeth pass [m]; 0 for rock or "
        "concrete. Stones and the machine stand on it.",
    )


class ObstacleSettings(Settings):
    """Something that stands on the ground and never moves: a wall, a parked machine, a tree."""

    shape: Literal["box", "cylinder"] = Field(
        "box", description="A box, or an upright cylinder such as the trunk of a tree."
    )
    at_m: tuple[Meters, Meters] = Field(description="Its middle (x, y) [m].")
    size_m: tuple[Meters, Meters, Meters] = Field(
        description="Length, width and height above the ground [m]; of a cylinder, the length is "
        "its diameter."
    )
    yaw_rad: Radians = Field(
        0.0, ge=-3.2, le=3.2, description="Direction of its length, from x [rad]."
    )

    @model_validator(mode="after")
    def _check_size(self) -> "ObstacleSettings":
        if not all(0.05 <= side <= 100 for side in self.size_m):
            raise ValueError(f"size_m is within 0.05 to 100 m a side, got {list(self.size_m)}")
        return self


class PersonSettings(Settings):
    """Somebody who walks along a line and back, and does not mind the machine."""

    path_m: tuple[tuple[Meters, Meters], ...] = Field(
        min_length=2,
        max_length=50,
        description="Corners (x, y) of the line, walked there and back.",
    )
    speed_m_s: MetersPerSecond = Field(1.2, gt=0, le=3, description="Speed [m/s].")
    height_m: Meters = Field(1.75, ge=0.5, le=2.5, description="Height [m].")
    width_m: Meters = Field(0.5, ge=0.2, le=1.5, description="Width, the same on all sides [m].")

    @model_validator(mode="after")
    def _check_path(self) -> "PersonSettings":
        if any(first == second for first, second in pairwise(self.path_m)):
            raise ValueError("path_m has the same corner twice in a row: leave one of them out")
        return self


class SiteSettings(Settings):
    """The ground, what stands on it, and the stones."""

    terrain: TerrainSettings = Field(TerrainSettings(), description="Shape of the ground.")
    stones: StoneSettings = Field(StoneSettings(), description="Which stones lie on it.")
    obstacles: tuple[ObstacleSettings, ...] = Field(
        (), max_length=50, description="What stands on it; stones keep their gap to it."
    )
    people: tuple[PersonSettings, ...] = Field((), max_length=20, description="Who walks on it.")
    liftable: bool | None = Field(
        None,
        description="Whether stones lie only where the machine may lift them (ISO 10567); if not "
        "given, in all scenarios but `kind`, and there where the machine may tip.",
    )
