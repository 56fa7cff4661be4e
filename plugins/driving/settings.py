"""Settings of the driving plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar

from pydantic import Field

from executive.config import Meters, MetersPerSecond, Settings
from executive.interfaces.declaration import PluginSettings


class GroundSettings(Settings):
    """What counts as ground that the machine may drive on."""

    cell_m: Meters = Field(0.4, ge=0.1, le=2, description="Cell of the grid of heights [m].")
    widest_object_m: Meters = Field(
        3.0, gt=0, le=20, description="What is narrower than this and rises is no ground [m]."
    )
    least_seen: float = Field(
        0.5, ge=0, le=1, description="Least share of the ground below the machine that is seen."
    )
    beside_m: Meters = Field(
        1.0, ge=0, le=5, description="Ground so near to seen ground counts as seen [m]."
    )
    own_m: Meters = Field(
        5.0,
        ge=0,
        le=20,
        description="Ground so near to the machine's present place counts as seen: it stands "
        "there, and its lidars do not look there [m].",
    )


class DubinsSettings(PluginSettings):
    """Paths, their clearance, and the tracker."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    ground: GroundSettings = Field(GroundSettings(), description="Where the machine may drive.")
    speed: MetersPerSecond = Field(
        0.6, gt=0, le=10, description="Wanted speed, at most that of the machine [m/s]."
    )
    clearance: Meters = Field(
        0.4, ge=0, le=5, description="Least distance of the machine from obstacles [m]."
    )
    wider: float = Field(
        1.25,
        ge=1,
        le=5,
        description="Radius of planned arcs over the least of the machine; the rest is for "
        "corrections.",
    )
    detour: Meters = Field(
        8.0, ge=0, le=50, description="How far beside the straight way a path may lead [m]."
    )
    return_within: Meters = Field(
        1.5, gt=0, le=20, description="Distance in which the tracker is back on its path [m]."
    )
