"""A stone that the machine keeps track of."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from executive.arrays import Float, checked
from executive.geometry.convex import volume_and_centroid
from executive.geometry.polygon import Box, outline_of, smallest_box
from executive.messages.weight import Weight

# Density of the rocks that walls are built of, granite, gneiss and limestone: 2600 to 2800 kg/m³
# (Schön 2015, Physical Properties of Rocks, Table 4.1).
STONE_DENSITY_KG_M3 = 2700.0


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
        weight: What it weighs; None until it was lifted and weighed.
        T_object_gripper: Grasps that have held it on the whole way to a place, oldest first: poses
            of the gripper in the object's frame, shape (K, 4, 4).
    """

    id: int
    state: StoneState
    points_map: Float
    centroid_map: Float
    T_map_object: Float
    seen_from_above: bool
    weight: Weight | None = None
    T_object_gripper: Float = field(default_factory=lambda: np.empty((0, 4, 4)))

    def __post_init__(self) -> None:
        object.__setattr__(self, "points_map", checked("points_map", self.points_map, None, 3))
        object.__setattr__(self, "centroid_map", checked("centroid_map", self.centroid_map, 3))
        object.__setattr__(self, "T_map_object", checked("T_map_object", self.T_map_object, 4, 4))
        grasps = checked("T_object_gripper", self.T_object_gripper, None, 4, 4)
        object.__setattr__(self, "T_object_gripper", grasps)

    @property
    def reach_m(self) -> float:
        """Distance of the farthest point from the centroid [m]."""
        return float(np.linalg.norm(self.points_map - self.centroid_map, axis=1).max())

    @property
    def volume_m3(self) -> float:
        """Volume of the convex hull of the known surface [m³].

        The underside is closed by the hull. A surface that was not seen down to the ground makes it
        too small, by 2 to 9 % on seven simulated stones.

        Raises:
            DataError: If the known surface spans no volume.
        """
        return volume_and_centroid(self.points_map)[0]

    @property
    def mass_by_volume_kg(self) -> float:
        """Mass [kg] by the volume, whether it was weighed or not."""
        return self.volume_m3 * STONE_DENSITY_KG_M3

    @property
    def mass_kg(self) -> float:
        """Mass [kg], weighed or estimated as `mass_source` tells."""
        return self.mass_by_volume_kg if self.weight is None else self.weight.mass_kg

    @property
    def mass_source(self) -> str:
        """Where the mass comes from."""
        if self.weight is not None:
            return f"weighed, ± {self.weight.std_kg:.0f} kg"
        return f"volume × {STONE_DENSITY_KG_M3:.0f} kg/m³, not weighed"

    @property
    def outline_map(self) -> Float:
        """Convex outline from above in the map [m], counter-clockwise, shape (V, 2)."""
        return outline_of(self.points_map)

    @property
    def box_map(self) -> Box:
        """Smallest rectangle around the outline from above, in the map."""
        return smallest_box(self.outline_map)

    @property
    def length_m(self) -> float:
        """Longest side of the stone: the longer side of its box from above, or its height [m]."""
        return max(self.box_map.length_m, self.height_m)

    @property
    def width_m(self) -> float:
        """Shorter side of the stone's box from above [m]."""
        return self.box_map.width_m

    @property
    def height_m(self) -> float:
        """Height from the lowest to the highest known point [m]."""
        return float(np.ptp(self.points_map[:, 2]))
