"""A stone that the machine keeps track of."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from executive.arrays import Float, checked


class StoneState(StrEnum):
    """State of a known stone."""

    ON_GROUND = "on_ground"
    HELD = "held"
    PLACED = "placed"
    SET_ASIDE = "set_aside"  # it stays where it lies, because it cannot be grasped
    LOST = "lost"

    @property
    def is_lying(self) -> bool:
        """Whether the stone lies at its pose in the database, where it is an obstacle."""
        return self in (StoneState.ON_GROUND, StoneState.PLACED, StoneState.SET_ASIDE)


@dataclass(frozen=True, slots=True, eq=False)
class Stone:
    """An object of the database (Mascaro 2020, Sec. 4.5): a globally referenced cloud with an
    identity.

    Attributes:
        id: Stable number, from 1.
        state: Its state.
        points_map: Its known surface in the map at its present pose [m], shape (N, 3).
        centroid_map: Mean of the points, in the map [m], shape (3,).
        T_map_object: Pose of the object's frame, shape (4, 4). When the stone is first seen, its
            origin is the centroid and its axes are those of the map.
        seen_from_above: Whether a drone survey's points are part of the model.
    """

    id: int
    state: StoneState
    points_map: Float
    centroid_map: Float
    T_map_object: Float
    seen_from_above: bool

    def __post_init__(self) -> None:
        object.__setattr__(self, "points_map", checked("points_map", self.points_map, None, 3))
        object.__setattr__(self, "centroid_map", checked("centroid_map", self.centroid_map, 3))
        object.__setattr__(self, "T_map_object", checked("T_map_object", self.T_map_object, 4, 4))

    @property
    def reach_m(self) -> float:
        """Distance of the farthest point from the centroid [m]."""
        return float(np.linalg.norm(self.points_map - self.centroid_map, axis=1).max())
