"""Reads `regions:`, and holds the names that leaves use against it.

regions:
  yard:     {box: [[2 m, -4 m], [8 m, 4 m]]}                      # two opposite corners
  corridor: {corridor: [[3 m, -6 m], [3 m, 6 m]], width: 3 m}     # a way, and its whole width
  bank:     {polygon: [[0 m, 5 m], [4 m, 5 m], [2 m, 8 m]]}
"""

import typing
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from executive.arrays import Float
from executive.config import Meters, Settings
from executive.errors import DataError, did_you_mean
from executive.leaf.region_name import NamesRegion
from executive.messages.region import Region
from executive.tree.reading import Reading, is_text
from executive.tree.settings import check_settings
from executive.tree.value import Listing, Table, plain

_FORMS = ("polygon", "box", "corridor")
Corner = tuple[Meters, Meters]
_FarEnough = Annotated[Meters, Field(gt=0, le=100)]


class RegionShape(Settings):
    """One region: a polygon, a box, or a corridor with its width; coordinates in the map."""

    polygon: tuple[Corner, ...] | None = Field(
        None, min_length=3, description="Corners, in order round the outline [m]."
    )
    box: tuple[Corner, Corner] | None = Field(
        None, description="Two opposite corners of a box along x and y [m]."
    )
    corridor: tuple[Corner, ...] | None = Field(
        None, min_length=2, description="Points of the way along its middle [m]."
    )
    width: _FarEnough | None = Field(None, description="Whole width of a corridor [m].")

    @model_validator(mode="after")
    def _check_form(self) -> "RegionShape":
        given = [form for form in _FORMS if getattr(self, form) is not None]
        if len(given) != 1:
            raise ValueError(
                f"a region is one of {', '.join(_FORMS)}; got {' and '.join(given) or 'none'}"
            )
        if (self.corridor is None) != (self.width is None):
            raise ValueError("a corridor, and only a corridor, has a 'width'")
        return self

    def corners(self) -> Float:
        """Return the corners of the outline [m], shape (N, 2)."""
        if self.polygon is not None:
            return np.array(self.polygon)
        if self.box is not None:
            (x0, y0), (x1, y1) = self.box
            return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
        return _widened(np.array(self.corridor), self.width or 0.0)


def read_regions(table: Table | None, reading: Reading) -> dict[str, Region]:
    """Return the regions of a mission by name; each mistake is noted at its place."""
    regions: dict[str, Region] = {}
    for name, entry in table.entries.items() if table else ():
        what = f"region '{name}'"
        shape = reading.table(entry.value, what)
        if reading.checked_name(name, entry.key_mark, "a region's name") is None or shape is None:
            continue
        settings = check_settings(RegionShape, shape, what, reading.problems)
        if settings is None:
            continue
        try:
            regions[name] = Region(name, settings.corners())
        except DataError as error:
            told = str(error)
            prefix = "" if what in told else f"{what}: "
            reading.problems.error(entry.value.mark, f"{prefix}{told}")
    return regions


def check_region_names(
    settings: type[Settings], table: Table, owner: str, reading: Reading
) -> None:
    """Note each setting in a table that names a region which the mission does not have."""
    for name, field in settings.model_fields.items():
        value = table.get(name)
        if value is None or not _names_region((field.annotation, *field.metadata)):
            continue
        for one in value.items if isinstance(value, Listing) else (value,):
            if is_text(one) and "{" not in str(plain(one)) and plain(one) not in reading.regions:
                cure = did_you_mean(plain(one), reading.regions)
                none = "" if reading.regions else "; the mission has no 'regions'"
                if reading.problems.is_partial:
                    continue
                reading.fail(one, f"'{name}' of {owner}: no region '{plain(one)}'{cure or none}")


def _names_region(kind: object) -> bool:
    """Whether `NamesRegion` marks a type, or a part of it such as the items of a list."""
    if isinstance(kind, NamesRegion):
        return True
    parts = kind if isinstance(kind, tuple) else typing.get_args(kind)
    return any(_names_region(part) for part in parts)


def _widened(way: Float, width_m: float) -> Float:
    """Return the outline of a way (N, 2) of a width: its joints are mitred, its ends square.

    Raises:
        DataError: If two points of the way are the same.
    """
    steps = np.diff(way, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    if (lengths < 1e-9).any():
        raise DataError("two neighbouring points of a corridor are the same")
    normals = np.column_stack([-steps[:, 1], steps[:, 0]]) / lengths[:, None]
    before, after = np.vstack([normals[:1], normals]), np.vstack([normals, normals[-1:]])
    mitres = before + after
    share = (mitres * before).sum(axis=1, keepdims=True)
    if (share < 0.2).any():  # a bend of more than 127° would put the mitre far outside
        raise DataError("a corridor bends back on itself: make two regions of it")
    offsets = mitres / share * width_m / 2
    return np.vstack([way - offsets, (way + offsets)[::-1]])
