"""A point cloud in a named frame."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Bool, Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """Points, and normals where they are known.

    Attributes:
        frame: Frame of the coordinates: `map`, or the name of a survey's own frame.
        points: Coordinates [m], shape (N, 3).
        normals: Unit outward normals, shape (N, 3), or None.
    """

    frame: str
    points: Float
    normals: Float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", checked("points", self.points, None, 3))
        if self.normals is not None:
            object.__setattr__(
                self, "normals", checked("normals", self.normals, len(self.points), 3)
            )

    def __len__(self) -> int:
        return len(self.points)

    def near(self, centre: Float, radius_m: float) -> "Cloud":
        """Return the points nearer than a horizontal distance to a place, normals kept.

        Args:
            centre: The place in the cloud's frame [m]; only its x and y count, shape (2,) or (3,).
            radius_m: The distance [m].
        """
        distances = np.hypot(*(self.points[:, :2] - centre[:2]).T)
        return self._only(np.asarray(distances < radius_m))

    def in_box(self, low: Float, high: Float) -> "Cloud":
        """Return the points in a box along the axes, limits included, normals kept.

        Args:
            low: Lowest corner in the cloud's frame [m], shape (3,).
            high: Highest corner [m], shape (3,).
        """
        inside = (self.points >= low) & (self.points <= high)
        return self._only(np.asarray(inside.all(axis=1)))

    def _only(self, kept: Bool) -> "Cloud":
        normals = None if self.normals is None else self.normals[kept]
        return Cloud(self.frame, self.points[kept], normals)
