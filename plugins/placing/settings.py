"""Settings of the placing plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar, Literal

from pydantic import Field

from executive.config import Meters, Radians
from executive.interfaces.declaration import PluginSettings


class SlotsSettings(PluginSettings):
    """Positions of slots, requirements on their ground, and the release of a stone."""

    needs: ClassVar[tuple[str, ...]] = ("machine", "motion")

    radii_m: tuple[Meters, ...] = Field(
        (6.0, 7.2, 5.0, 4.2),
        min_length=1,
        description="Distances of rows of slots from the machine, preferred first [m].",
    )
    prefer: Literal["by_base", "given", "nearest", "capacity"] = Field(
        "by_base",
        description="Which slots come first: those of the first row given with room for all; the "
        "nearest; or, by `capacity`, for each stone of the site one where the machine may lift it "
        "(ISO 10567), with the least swings of the cabin in all; `by_base`: by capacity where the "
        "base may tip (`on_legs`, `on_wheels`), else as given.",
    )
    spacing_m: Meters = Field(
        1.9, gt=0, description="Distance between slots of a row; open jaws must fit between [m]."
    )
    sector_rad: Radians = Field(
        6.28, gt=0, le=6.2832, description="Sector around the machine's front that is used [rad]."
    )
    clearance_m: Meters = Field(
        1.2, gt=0, description="Least distance of a slot's centre from any segment [m]."
    )
    max_slope_rad: Radians = Field(0.2, gt=0, lt=1.5, description="Largest ground slope [rad].")
    max_roughness_m: Meters = Field(
        0.08, gt=0, description="Largest standard deviation of ground heights from their plane [m]."
    )
    drop_m: Meters = Field(
        0.05, ge=0, description="Height of the stone's bottom above ground at the release [m]."
    )
    approach_m: Meters = Field(
        0.8, ge=0, description="Length of the straight descent to a slot, in reach [m]."
    )
    turns: int = Field(24, ge=1, le=360, description="Number of yaws of a stone over its slot.")
    max_placements: int = Field(
        4, ge=1, description="Most ways to set a stone down that are returned."
    )
