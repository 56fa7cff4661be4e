"""A point cloud in a named frame."""

from dataclasses import dataclass

from executive.arrays import Float, checked


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
