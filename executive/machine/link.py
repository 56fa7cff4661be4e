"""A rigid body of the machine."""

from functools import cached_property

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.machine.origin import Vec3
from executive.machine.provenance import Sourced
from executive.machine.shape import Shape


class Link(Sourced):
    """Mass and shapes of a body, in the frame of the joint that carries it."""

    name: str = Field(description="Unique name.")
    mass_kg: float = Field(gt=0, description="Mass [kg].")
    com_m: Vec3 = Field(description="Centre of mass [m].")
    shapes: tuple[Shape, ...] = Field(description="Convex shapes that enclose it together.")

    @cached_property
    def inertia_diagonal(self) -> Float:
        """Principal moments about the centre of mass [kg·m²], shape (3,).

        They are those of a homogeneous box with the extents of the shapes, because the real mass
        distribution is not public.
        """
        corners = np.vstack([shape.vertices for shape in self.shapes])
        squares = np.ptp(corners, axis=0) ** 2
        return np.asarray(self.mass_kg / 12 * (squares.sum() - squares))
