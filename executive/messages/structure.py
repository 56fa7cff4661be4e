"""What is to be built of found stones: a band along a centre line, with a height and a batter."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from executive.arrays import Bool, Float, checked
from executive.errors import DataError


@dataclass(frozen=True, eq=False)
class Structure:
    """The envelope of a wall, a row, a ring or a cairn, over the ground as it is.

    A line of one point is a cairn: round, with `thickness_m` as its diameter. A line whose ends are
    one point is a ring.

    Attributes:
        name: What people call it.
        line: Centre line in the map [m], shape (N, 2); a curve is given by many points.
        thickness_m: Width at the foot [m].
        height_m: Height above the ground below each point [m].
        batter_rad: How far each face leans inwards from the vertical [rad].
        faces: 2: both sides are faces, and lean. 1: only the side to the left of the line does, the
            other is vertical, as at a bank.
    """

    name: str
    line: Float
    thickness_m: float
    height_m: float
    batter_rad: float = 0.0
    faces: int = 2

    def __post_init__(self) -> None:
        object.__setattr__(self, "line", checked("line", self.line, None, 2))
        if not len(self.line):
            raise DataError(f"structure '{self.name}': its line has no point")
        if len(self.line) > 1 and not (self._lengths > 0).all():
            raise DataError(f"structure '{self.name}': two successive points of its line are one")
        lean_m = self.faces * self.height_m * np.tan(self.batter_rad)
        if not self.height_m > 0 or not lean_m < self.thickness_m or self.faces not in (1, 2):
            raise DataError(
                f"structure '{self.name}': its faces meet below its top; give less batter or "
                "height, or more thickness"
            )

    @cached_property
    def _lengths(self) -> Float:
        return np.asarray(np.linalg.norm(np.diff(self.line, axis=0), axis=1))

    @property
    def length_m(self) -> float:
        """Return the length of the centre line [m]; 0 of a cairn."""
        return float(self._lengths.sum())

    @property
    def is_ring(self) -> bool:
        """Return whether the line ends where it begins."""
        return len(self.line) > 2 and bool(np.allclose(self.line[0], self.line[-1]))

    def along_across(self, xy: Float) -> tuple[Float, Float]:
        """Return where points (M, 2) are: along the line, and across it to its left, (M,) [m].

        Beyond an open end, `along` is negative or more than the length. Of a cairn, `across` is the
        distance from the middle, and `along` is 0.
        """
        if len(self.line) == 1:
            return np.zeros(len(xy)), np.linalg.norm(xy - self.line[0], axis=1)
        begins = np.concatenate([[0.0], np.cumsum(self._lengths)])
        along, across = np.zeros(len(xy)), np.zeros(len(xy))
        nearest = np.full(len(xy), np.inf)
        last = len(self._lengths) - 1
        for i, length in enumerate(self._lengths):
            direction = (self.line[i + 1] - self.line[i]) / length
            away = xy - self.line[i]
            forward = away @ direction
            left = away @ np.array([-direction[1], direction[0]])
            inner = np.clip(forward, 0.0, length)
            distance = np.hypot(forward - inner, left)
            is_open = not self.is_ring
            low = -np.inf if i == 0 and is_open else 0.0
            high = np.inf if i == last and is_open else length
            is_better = distance < nearest - 1e-12
            along = np.where(is_better, begins[i] + np.clip(forward, low, high), along)
            side = np.where(left < 0, -1.0, 1.0)
            at_end = (forward < low) | (forward > high)
            across = np.where(is_better, np.where(at_end, side * distance, left), across)
            nearest = np.minimum(distance, nearest)
        return along, across

    def heading_rad(self, along_m: float) -> float:
        """Return the direction of the line at a length along it, from x towards y [rad]."""
        if len(self.line) == 1:
            return 0.0
        i = int(np.clip(np.searchsorted(np.cumsum(self._lengths), along_m), 0, len(self.line) - 2))
        x, y = self.line[i + 1] - self.line[i]
        return float(np.arctan2(y, x))

    def point(self, along_m: float) -> Float:
        """Return the point of the centre line at a length along it [m], shape (2,)."""
        begins = np.concatenate([[0.0], np.cumsum(self._lengths)])
        return np.array([np.interp(along_m, begins, self.line[:, k]) for k in (0, 1)])

    def bounds(self) -> tuple[Float, Float]:
        """Return the corners of the box from above that holds the foot [m], (2,) each."""
        half = self.thickness_m / 2
        return self.line.min(axis=0) - half, self.line.max(axis=0) + half

    def depth_m(self, xy: Float, above_ground_m: Float) -> Float:
        """Return how deep points are in the envelope, seen from above; negative outside, (M,) [m].

        Args:
            xy: Points (M, 2).
            above_ground_m: Their heights above the ground below them, (M,); the faces lean.
        """
        along, across = self.along_across(xy)
        lean = np.maximum(above_ground_m, 0.0) * np.tan(self.batter_rad)
        half = self.thickness_m / 2
        left = half - lean - across
        right = half - (lean if self.faces == 2 else 0.0) + across
        sides = left if len(self.line) == 1 else np.minimum(left, right)
        if len(self.line) == 1 or self.is_ring:
            return np.asarray(sides)
        return np.asarray(np.minimum(sides, np.minimum(along, self.length_m - along)))

    def holds(self, xy: Float, above_ground_m: Float) -> Bool:
        """Return which points lie in the envelope, also by their height, shape (M,)."""
        is_below_top = above_ground_m <= self.height_m
        return np.asarray((self.depth_m(xy, above_ground_m) >= 0) & is_below_top)

    def volume_m3(self) -> float:
        """Return the volume of the envelope [m³]."""
        lean = self.height_m * np.tan(self.batter_rad)
        if len(self.line) == 1:
            foot, top = self.thickness_m / 2, self.thickness_m / 2 - lean
            return float(np.pi * self.height_m * (foot**2 + foot * top + top**2) / 3)
        return float(self.length_m * self.height_m * (self.thickness_m - self.faces * lean / 2))
