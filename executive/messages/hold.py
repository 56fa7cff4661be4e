"""The stone that the gripper holds."""

from dataclasses import dataclass

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class Hold:
    """Which stone is held, and how.

    Attributes:
        stone_id: The stone's id in the object database.
        T_map_gripper: Pose of the gripper when its jaws had closed, shape (4, 4).
        jaw_rad: Angle of the jaws when they had closed [rad].
    """

    stone_id: int
    T_map_gripper: Float
    jaw_rad: float

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "T_map_gripper", checked("T_map_gripper", self.T_map_gripper, 4, 4)
        )
