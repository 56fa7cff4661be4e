"""The two-jaw gripper: its polyhedra at any opening, and the opening at any jaw angle.

Frame: origin at the palm's centre, x out of the palm (approach), y from jaw to jaw, z along the
jaws' width.
"""

import math
from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Settings
from executive.errors import DataError
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import about_axis
from executive.machine.link import Link
from executive.machine.origin import Vec3
from executive.machine.provenance import REST, Sourced
from executive.machine.shape import Shape

Vec2 = tuple[float, float]
SIDES = {"jaw_left": 1.0, "jaw_right": -1.0}  # sign of y, and of the opening rotation about z


class JawPart(Settings):
    """A convex polygon in the x-y plane, extruded along z over one or more spans: plate or ribs."""

    corners_m: tuple[Vec2, ...] = Field(
        min_length=3, description="Corners (x, y) from the left jaw's pivot [m]."
    )
    spans_m: tuple[Vec2, ...] = Field(
        min_length=1, description="Start and end along z [m], one pair for each rib."
    )

    def shapes(self, side: float) -> Iterator[Shape]:
        """Yield the part's prisms in the frame of the left (+1) or the right (−1) jaw."""
        for span in self.spans_m:
            yield Shape(
                kind="hull",
                points_m=tuple((x, side * y, z) for z in span for x, y in self.corners_m),
            )


class Gripper(Sourced):
    """A palm and two mirrored jaws that rotate about axes along z."""

    palm_shapes: tuple[Shape, ...] = Field(
        min_length=1, description="Convex parts of the palm, in the gripper frame."
    )
    palm_mass_kg: float = Field(gt=0, description="Mass without the jaws [kg].")
    palm_com_m: Vec3 = Field(description="Centre of mass of the palm [m].")
    jaw_mass_kg: float = Field(gt=0, description="Mass of one jaw [kg].")
    jaw_com_m: Vec3 = Field(description="Centre of mass of the left jaw, from its pivot [m].")
    pivot_m: Vec2 = Field(description="Position x, y of the left jaw's pivot [m].")
    jaw_parts: tuple[JawPart, ...] = Field(
        min_length=1, description="Convex parts of the closed left jaw."
    )
    tip_m: Vec2 = Field(description="Tip of the closed left jaw, from its pivot [m].")
    open_rad: float = Field(gt=0, lt=math.pi, description="Angle of the widest opening [rad].")
    tip_force_n: float = Field(gt=0, description="Largest force at each tip [N].")
    grasp_centre_m: Vec3 = Field(description="Where a stone's centre sits between the jaws [m].")
    digs_m: float = Field(
        0.0,
        ge=0,
        le=0.5,
        description="How far the tips may be pressed into the soil beside a stone [m].",
    )

    @property
    def jaw_width_m(self) -> float:
        """Extent of the jaws along z [m]."""
        ends = [z for part in self.jaw_parts for span in part.spans_m for z in span]
        return max(ends) - min(ends)

    @property
    def grasp_centre(self) -> Float:
        """Where a stone's centre sits between the jaws, in the gripper frame [m], shape (3,)."""
        return np.array(self.grasp_centre_m)

    @property
    def tooth_half_width_m(self) -> float:
        """Half the extent along z of the part of the jaw that ends in the tip [m]."""
        return min(
            (max(ends) - min(ends)) / 2
            for part in self.jaw_parts
            if self.tip_m in part.corners_m
            for ends in [[z for span in part.spans_m for z in span]]
        )

    @property
    def tip_radius_m(self) -> float:
        """Distance of a tip from its pivot [m]."""
        return math.hypot(*self.tip_m)

    @property
    def max_opening_m(self) -> float:
        """Distance of the tips at the widest opening [m]."""
        return self.opening_m(self.open_rad)

    def opening_m(self, jaw_rad: float) -> float:
        """Return the distance of the two tips [m]."""
        return 2 * (self.pivot_m[1] + self.tip_radius_m * math.sin(jaw_rad + self._tip_angle))

    def jaw_rad(self, opening_m: float) -> float:
        """Return the jaw angle [rad] at which the tips are a distance [m] apart.

        Raises:
            DataError: If no jaw angle gives this distance.
        """
        # Rounding may make the opening of closed jaws slightly negative.
        least, most = max(self.opening_m(0.0), 0.0), self.max_opening_m
        if not least - 1e-9 <= opening_m <= most + 1e-9:
            raise DataError(
                f"no jaw angle gives an opening of {opening_m:.3f} m; ask for {least:.2f} "
                f"to {most:.2f} m"
            )
        return math.asin((opening_m / 2 - self.pivot_m[1]) / self.tip_radius_m) - self._tip_angle

    def tips(self, jaw_rad: float) -> Float:
        """Return the left and the right tip in the gripper frame [m], shape (2, 3)."""
        tip = np.array([*self.tip_m, 0.0])
        return np.array(
            [
                transform(self.T_gripper_jaw(name, jaw_rad), tip * (1, s, 1))
                for name, s in SIDES.items()
            ]
        )

    def hulls(self, jaw_rad: float) -> dict[str, tuple[Float, ...]]:
        """Return the corners of all convex parts of `palm`, `jaw_left` and `jaw_right`, by name.

        Each part has shape (V, 3), in the gripper frame [m].
        """
        parts = {"palm": tuple(shape.vertices for shape in self.palm_shapes)}
        for name in SIDES:
            T = self.T_gripper_jaw(name, jaw_rad)
            parts[name] = tuple(transform(T, shape.vertices) for shape in self.links[name].shapes)
        return parts

    def T_gripper_jaw(self, name: str, jaw_rad: float) -> Float:
        """Return the pose of `jaw_left` or `jaw_right` at a jaw angle [rad], shape (4, 4)."""
        side, (x, y) = SIDES[name], self.pivot_m
        return pose(about_axis(np.array([0.0, 0.0, side]), jaw_rad), np.array([x, side * y, 0.0]))

    @cached_property
    def links(self) -> Mapping[str, Link]:
        """The jaws as links by name; the palm belongs to the link that carries it."""
        return {name: self._jaw_link(name, side) for name, side in SIDES.items()}

    def palm_link(self, name: str) -> Link:
        """Return the palm as a link of the given name."""
        return Link(
            name=name,
            mass_kg=self.palm_mass_kg,
            com_m=self.palm_com_m,
            shapes=self.palm_shapes,
            provenance={REST: self.provenance_of("palm_shapes")},
        )

    def _jaw_link(self, name: str, side: float) -> Link:
        x, y, z = self.jaw_com_m
        return Link(
            name=name,
            mass_kg=self.jaw_mass_kg,
            com_m=(x, side * y, z),
            shapes=tuple(shape for part in self.jaw_parts for shape in part.shapes(side)),
            provenance={REST: self.provenance_of("jaw_parts")},
        )

    @property
    def _tip_angle(self) -> float:
        return math.atan2(self.tip_m[1], self.tip_m[0])
