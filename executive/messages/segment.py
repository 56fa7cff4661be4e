"""An object-like part of a cloud."""

from dataclasses import dataclass

from executive.arrays import Float, checked
from executive.messages.cloud import Cloud


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """Points of one object on the ground (Mascaro 2020, Sec. 4.3).

    Attributes:
        id: Number within its segmentation, 0 for the one of most points.
        points: Points of the object in the frame of the segmented cloud [m], shape (N, 3).
        centroid: Mean of the points [m], shape (3,).
        extents: Side lengths of the box along the principal axes, longest first [m], shape (3,).
    """

    id: int
    points: Float
    centroid: Float
    extents: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", checked("points", self.points, None, 3))
        object.__setattr__(self, "centroid", checked("centroid", self.centroid, 3))
        object.__setattr__(self, "extents", checked("extents", self.extents, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Segmentation:
    """A cloud split into its ground and the objects on it.

    Attributes:
        frame: Frame of all coordinates.
        segments: Object-like parts, the one of most points first.
        ground: Points classified as ground.
        ground_plane: Unit normal n (pointing up) and offset d with n·p = d [m], shape (4,).
    """

    frame: str
    segments: tuple[Segment, ...]
    ground: Cloud
    ground_plane: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "ground_plane", checked("ground_plane", self.ground_plane, 4))
