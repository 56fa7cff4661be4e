"""The place for a stone, and the release there."""

from dataclasses import dataclass

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class Slot:
    """A free place for one stone.

    Attributes:
        id: Number, from 1.
        position_map: Point on the ground below the desired place of the stone's centroid [m], shape
            (3,). Of a slot with a heading, it is below the middle of the stone's box from above.
        heading_rad: Direction of the longer side of the stone's box from above, from x towards y
            [rad]; None leaves it to the planner.
        gap_m: Distance wanted between the faces of the stone and of its neighbours [m]; None leaves
            it to the planner.
        T_map_object: Pose in which the object's frame of one certain stone is to rest, shape
            (4, 4), as a building planner found it; the heading then does not count. None leaves
            the pose to the planner.
        meant_for_map: Where the stone lies that the planner chose this place for [m], shape (3,);
            None if it is for any stone.
    """

    id: int
    position_map: Float
    heading_rad: float | None = None
    gap_m: float | None = None
    T_map_object: Float | None = None
    meant_for_map: Float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "position_map", checked("position_map", self.position_map, 3))
        if self.meant_for_map is not None:
            meant = checked("meant_for_map", self.meant_for_map, 3)
            object.__setattr__(self, "meant_for_map", meant)
        if self.T_map_object is not None:
            object.__setattr__(
                self, "T_map_object", checked("T_map_object", self.T_map_object, 4, 4)
            )


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """The release of a held stone.

    Attributes:
        slot: The slot that the stone is placed in.
        T_map_gripper: Pose of the gripper at the release, shape (4, 4).
        T_map_object: Resulting pose of the stone's object frame, shape (4, 4).
    """

    slot: Slot
    T_map_gripper: Float
    T_map_object: Float

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "T_map_gripper", checked("T_map_gripper", self.T_map_gripper, 4, 4)
        )
        object.__setattr__(self, "T_map_object", checked("T_map_object", self.T_map_object, 4, 4))
