"""The form of a structure as settings: what a file of a structure, and a leaf, say of it."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from executive.arrays import Float
from executive.config import Meters, Radians, Settings
from executive.errors import DataError
from executive.messages.structure import Structure

_CORNERS = 48  # of a ring
Point = tuple[Meters, Meters]
_Length = Annotated[Meters, Field(gt=0, le=50)]


class RingShape(Settings):
    """A closed circle."""

    centre: Point = Field((0.0, 0.0), description="Its middle [m].")
    radius: _Length = Field(2.0, description="From the middle to the centre line [m].")


class StructureShape(Settings):
    """A wall, a row, a ring or a cairn."""

    line: tuple[Point, ...] | None = Field(
        None,
        min_length=2,
        examples=[[["-2 m", "6 m"], ["2 m", "6 m"]]],
        description="Points of the centre line [m].",
    )
    ring: RingShape | None = Field(None, description="A closed circle: its centre and radius.")
    cairn: Point | None = Field(None, description="The middle of a round heap [m].")
    thickness: _Length = Field(1.3, description="Width at the foot; the diameter of a cairn [m].")
    height: _Length = Field(1.5, description="Above the ground [m].")
    batter: Radians = Field(0.0, ge=0, lt=0.8, description="Lean of each face inwards [rad].")
    faces: Literal[1, 2] = Field(2, description="Sides that lean: both, or the left one alone.")

    @model_validator(mode="after")
    def _check_form(self) -> "StructureShape":
        given = [form for form in ("line", "ring", "cairn") if getattr(self, form) is not None]
        if len(given) != 1:
            told = " and ".join(given) or "none"
            raise ValueError(f"a structure has one of line, ring, cairn; got {told}")
        try:
            self.shaped("structure")
        except DataError as error:
            raise ValueError(str(error)) from error
        return self

    def shaped(self, name: str) -> Structure:
        """Return the structure that is described."""
        return Structure(name, self._points(), self.thickness, self.height, self.batter, self.faces)

    def _points(self) -> Float:
        """Return the centre line [m], shape (N, 2)."""
        if self.line is not None:
            return np.array(self.line)
        if self.ring is None:
            return np.array([self.cairn])
        angles = 2 * np.pi * np.arange(_CORNERS + 1) / _CORNERS
        circle = np.column_stack([np.cos(angles), np.sin(angles)])
        circle[-1] = circle[0]
        return np.asarray(self.ring.centre + self.ring.radius * circle)
