"""Convex shapes of a link, for collision tests and for the self-filter of scans."""

from functools import cached_property
from itertools import product
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from executive.arrays import Float, checked
from executive.geometry.pose import transform
from executive.machine.origin import Origin, Vec3

_SIDES = 16  # number of sides of the prism that replaces a cylinder


class Shape(Origin):
    """A box, a cylinder about its z axis, or the convex hull of points."""

    kind: Literal["box", "cylinder", "hull"] = Field(description="Kind of shape.")
    size: tuple[float, ...] = Field(
        (), description="Box: full sides x, y, z [m]. Cylinder: radius, length [m]."
    )
    points_m: tuple[Vec3, ...] = Field(
        (), description="Hull: its corners in the shape's own frame [m]."
    )

    @model_validator(mode="after")
    def _check(self) -> "Shape":
        wanted = {"box": 3, "cylinder": 2, "hull": 0}[self.kind]
        if len(self.size) != wanted or min(self.size, default=1.0) <= 0:
            raise ValueError(f"a {self.kind} has {wanted} positive sizes, got {list(self.size)}")
        if (self.kind == "hull") != (len(self.points_m) >= 4):
            raise ValueError("a hull has at least four points_m, and other shapes have none")
        return self

    @property
    def T_link_shape(self) -> Float:
        """Pose of the shape in its link, shape (4, 4)."""
        return self.T

    @cached_property
    def vertices(self) -> Float:
        """Corners in the link's frame [m], shape (V, 3); for a cylinder, of a prism around it."""
        return checked("vertices", transform(self.T, self._corners()), None, 3)

    def _corners(self) -> Float:
        if self.kind == "hull":
            return np.array(self.points_m)
        if self.kind == "box":
            return np.asarray(np.array(list(product((-0.5, 0.5), repeat=3))) * np.array(self.size))
        radius, length = self.size
        angle = np.arange(_SIDES) * 2 * np.pi / _SIDES
        ring = np.c_[np.cos(angle), np.sin(angle)] * radius / np.cos(np.pi / _SIDES)
        return np.vstack([np.c_[ring, np.full(_SIDES, z)] for z in (-length / 2, length / 2)])
