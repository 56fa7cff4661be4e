"""A sector of a ring on the ground."""

import math
from dataclasses import dataclass

from executive.arrays import Float, checked
from executive.errors import DataError


@dataclass(frozen=True, slots=True, eq=False)
class Sector:
    """The part of a ring about a vertical axis that lies within an angle of a heading.

    Attributes:
        centre_map: x and y of the axis in the map [m], shape (2,).
        heading_rad: Middle of the sector, from the map's x axis towards its y axis [rad].
        angle_rad: Whole angle of the sector [rad].
        nearest_m: Inner radius [m].
        farthest_m: Outer radius [m].
    """

    centre_map: Float
    heading_rad: float
    angle_rad: float
    nearest_m: float
    farthest_m: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre_map", checked("centre_map", self.centre_map, 2))
        if not 0 <= self.nearest_m < self.farthest_m < math.inf or self.angle_rad <= 0:
            raise DataError(
                f"a sector of {self.angle_rad} rad from {self.nearest_m} m to "
                f"{self.farthest_m} m: the angle must be positive, and the outer radius larger "
                "than the inner"
            )
