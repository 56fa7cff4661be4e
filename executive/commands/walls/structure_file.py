"""Reads a file that says what is to be built, of which stones, by which planner.

structure: wall
line: [[-3 m, 0 m], [3 m, 0 m]]   # or `ring: {centre: […], radius: 2 m}`, or `cairn: [0 m, 0 m]`
thickness: 1.3 m
height: 1.5 m
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from executive.config import KilogramsPerCubicMeter, Meters, Radians, Settings
from executive.errors import ConfigError
from executive.leaf.structure_shape import StructureShape
from executive.messages.building import AsBuilt
from executive.messages.height_grid import HeightGrid
from executive.tree.document import read_file
from executive.tree.problem import Problems
from executive.tree.settings import check_settings
from executive.tree.value import Table, TableEntry, plain

_AROUND_M = 4.0  # of ground around the structure
_PLANNER = "building"


class GroundShape(Settings):
    """A plane."""

    slope: Radians = Field(0.0, ge=0, lt=0.6, description="Slope [rad].")
    heading: Radians = Field(0.0, description="Direction in which it rises, from x to y [rad].")


class StoneChoice(Settings):
    """Which stones of the folder are used, and what is assumed of them."""

    scale: float = Field(1.0, gt=0, le=1000, description="From the unit of the files to metres.")
    density: KilogramsPerCubicMeter = Field(2600.0, gt=0, le=8000, description="Of the rock.")
    count: int | None = Field(None, ge=0, description="So many, drawn by the seed; all if absent.")
    repair: Literal["refuse", "hull"] = Field("refuse", description=(
        "What becomes of a mesh with holes: it is left out, or its convex hull is taken."
    ))  # fmt: skip


class StructureFile(StructureShape):
    """What a file says, but for the planner's own settings."""

    structure: str = Field("wall", min_length=1, description="A name.")
    ground: GroundShape = GroundShape()
    stones: StoneChoice = StoneChoice()
    noise: Meters = Field(0.03, ge=0, le=0.5, description="Of a release, each axis [m].")
    tilt_noise: Radians = Field(0.035, ge=0, le=0.5, description="Of a release [rad].")
    most: int = Field(40, ge=1, le=500, description="Stones after which the trial ends.")


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """A structure that is to be built.

    Attributes:
        file: What the file says.
        built: The structure on bare ground.
        planner: Plugin and settings of `building`, as the file writes them.
    """

    file: StructureFile
    built: AsBuilt
    planner: Any


def read_structure(path: Path) -> Task:
    """Read a file.

    Raises:
        MissionFileError: If it is wrong; each mistake is told with file, line and column.
        ConfigError: If the structure is impossible.
    """
    problems = Problems()
    document = read_file(path, str(path), problems, "structure")
    problems.raise_errors()
    if not isinstance(document, Table):
        raise ConfigError(f"{path}:1: a structure is a mapping; begin with 'structure: wall'")
    chosen = document.get(_PLANNER)
    rest: dict[str, TableEntry] = {k: v for k, v in document.entries.items() if k != _PLANNER}
    file = check_settings(StructureFile, Table(rest, document.mark), "a structure", problems)
    problems.raise_errors()
    if file is None:
        raise ConfigError(f"{path}: this structure cannot be read")
    planner = plain(chosen) if chosen is not None else {"plugin": "dry_stone"}
    if isinstance(planner, dict):
        planner = {"plugin": "dry_stone", **planner}
    return Task(file, _bare(file), planner)


def _bare(file: StructureFile) -> AsBuilt:
    structure = file.shaped(file.structure)
    low, high = structure.bounds()
    ground = HeightGrid.plane(
        low - _AROUND_M, high + _AROUND_M, file.ground.slope, file.ground.heading
    )
    return AsBuilt(structure, ground)
