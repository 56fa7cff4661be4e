"""Reads a file that says what is to be built, of which stones, by which planner.

structure: wall
line: [[-3 m, 0 m], [3 m, 0 m]]   # or `ring: {centre: […], radius: 2 m}`, or `cairn: [0 m, 0 m]`
thickness: 1.3 m
height: 1.5 m
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from executive.arrays import Float
from executive.config import KilogramsPerCubicMeter, Meters, Radians, Settings
from executive.errors import ConfigError, DataError
from executive.messages.building import AsBuilt
from executive.messages.height_grid import HeightGrid
from executive.messages.structure import Structure
from executive.tree.document import read_file
from executive.tree.problem import Problems
from executive.tree.settings import check_settings
from executive.tree.value import Table, TableEntry, plain

_AROUND_M = 4.0  # of ground around the structure
_CORNERS = 48  # of a ring
_PLANNER = "building"
Point = tuple[Meters, Meters]
_Length = Annotated[Meters, Field(gt=0, le=50)]


class RingShape(Settings):
    """A closed circle."""

    centre: Point = Field((0.0, 0.0), description="Its middle [m].")
    radius: _Length = Field(2.0, description="From the middle to the centre line [m].")


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


class StructureFile(Settings):
    """What a file says, but for the planner's own settings."""

    structure: str = Field("wall", min_length=1, description="A name.")
    line: tuple[Point, ...] | None = Field(None, min_length=2, description="Centre line [m].")
    ring: RingShape | None = None
    cairn: Point | None = Field(None, description="The middle of a round heap [m].")
    thickness: _Length = Field(1.3, description="Width at the foot; the diameter of a cairn [m].")
    height: _Length = Field(1.5, description="Above the ground [m].")
    batter: Radians = Field(0.0, ge=0, lt=0.8, description="Lean of each face inwards [rad].")
    faces: Literal[1, 2] = Field(2, description="Sides that lean: both, or the left one alone.")
    ground: GroundShape = GroundShape()
    stones: StoneChoice = StoneChoice()
    noise: Meters = Field(0.03, ge=0, le=0.5, description="Of a release, each axis [m].")
    tilt_noise: Radians = Field(0.035, ge=0, le=0.5, description="Of a release [rad].")
    most: int = Field(40, ge=1, le=500, description="Stones after which the trial ends.")

    @model_validator(mode="after")
    def _check_form(self) -> "StructureFile":
        given = [form for form in ("line", "ring", "cairn") if getattr(self, form) is not None]
        if len(given) != 1:
            told = " and ".join(given) or "none"
            raise ValueError(f"a structure has one of line, ring, cairn; got {told}")
        return self

    def points(self) -> Float:
        """Return the centre line [m], shape (N, 2)."""
        if self.line is not None:
            return np.array(self.line)
        if self.ring is None:
            return np.array([self.cairn])
        angles = 2 * np.pi * np.arange(_CORNERS + 1) / _CORNERS
        circle = np.column_stack([np.cos(angles), np.sin(angles)])
        circle[-1] = circle[0]
        return np.asarray(self.ring.centre + self.ring.radius * circle)


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
    return Task(file, _bare(path, file), planner)


def _bare(path: Path, file: StructureFile) -> AsBuilt:
    try:
        structure = Structure(
            file.structure, file.points(), file.thickness, file.height, file.batter, file.faces
        )
    except DataError as error:
        raise ConfigError(f"{path}: {error}") from error
    low, high = structure.bounds()
    ground = HeightGrid.plane(
        low - _AROUND_M, high + _AROUND_M, file.ground.slope, file.ground.heading
    )
    return AsBuilt(structure, ground)
