"""A request for a motion of the arm, and the planner's answer."""

from dataclasses import dataclass

from executive.arrays import Float, checked
from executive.messages.cloud import Cloud
from executive.messages.trajectory import JointTrajectory


@dataclass(frozen=True, slots=True, eq=False)
class MoveRequest:
    """Move the gripper to a pose: up from the start, above the obstacles, and down to the goal.

    Attributes:
        start: Present positions of the arm's joints, in the machine's order, shape (n,).
        T_map_gripper: The goal, shape (4, 4).
        T_map_base: Pose of the chassis, shape (4, 4).
        leave_m: Length of the straight motion up from the start [m]; 0 for none.
        arrive_m: Length of the straight motion down to the goal [m]; 0 for none.
        obstacles: Ground and stones that must not be touched, in the map; a held stone is not among
            them.
        held_gripper: Surface of a held stone in the gripper's frame [m], shape (N, 3), or None.
        jaw_rad: Opening of the jaws during the motion [rad].
        held_kg: The most that the held stone weighs [kg]; None if it was not weighed.
    """

    start: Float
    T_map_gripper: Float
    T_map_base: Float
    leave_m: float
    arrive_m: float
    obstacles: Cloud
    held_gripper: Float | None
    jaw_rad: float
    held_kg: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", checked("start", self.start, None))
        object.__setattr__(
            self, "T_map_gripper", checked("T_map_gripper", self.T_map_gripper, 4, 4)
        )
        object.__setattr__(self, "T_map_base", checked("T_map_base", self.T_map_base, 4, 4))
        if self.held_gripper is not None:
            object.__setattr__(
                self, "held_gripper", checked("held_gripper", self.held_gripper, None, 3)
            )


@dataclass(frozen=True, slots=True, eq=False)
class PostureRequest:
    """Move the arm's joints to given positions, around the obstacles.

    Attributes:
        start: Present positions of the arm's joints, in the machine's order, shape (n,).
        goal: Wanted positions [rad] or [m], shape (n,).
        T_map_base: Pose of the chassis, shape (4, 4).
        obstacles: Ground and stones that must not be touched, in the map; a held stone is not among
            them.
        held_gripper: Surface of a held stone in the gripper's frame [m], shape (N, 3), or None.
        jaw_rad: Opening of the jaws during the motion [rad].
        held_kg: The most that the held stone weighs [kg]; None if it was not weighed.
    """

    start: Float
    goal: Float
    T_map_base: Float
    obstacles: Cloud
    held_gripper: Float | None
    jaw_rad: float
    held_kg: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", checked("start", self.start, None))
        object.__setattr__(self, "goal", checked("goal", self.goal, len(self.start)))
        object.__setattr__(self, "T_map_base", checked("T_map_base", self.T_map_base, 4, 4))
        if self.held_gripper is not None:
            object.__setattr__(
                self, "held_gripper", checked("held_gripper", self.held_gripper, None, 3)
            )


@dataclass(frozen=True, slots=True, eq=False)
class Around:
    """What surrounds the machine while it sweeps.

    Attributes:
        T_map_base: Pose of the chassis, shape (4, 4).
        obstacles: Ground and stones that must not be touched, in the map; a held stone is not among
            them.
        jaw_rad: Opening of the jaws during the motion [rad].
        held_gripper: Surface of a held stone in the gripper's frame [m], shape (N, 3), or None.
        held_kg: The most that the held stone weighs [kg]; None if it was not weighed.
    """

    T_map_base: Float
    obstacles: Cloud
    jaw_rad: float
    held_gripper: Float | None = None
    held_kg: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "T_map_base", checked("T_map_base", self.T_map_base, 4, 4))
        if self.held_gripper is not None:
            object.__setattr__(
                self, "held_gripper", checked("held_gripper", self.held_gripper, None, 3)
            )


@dataclass(frozen=True, slots=True, eq=False)
class MotionPlan:
    """A trajectory, or the reason why there is none.

    Attributes:
        trajectory: The motion, or None.
        reason: Why there is none; empty otherwise.
        path_map: Positions of the gripper along it [m], shape (m, 3), for viewers.
    """

    trajectory: JointTrajectory | None
    reason: str
    path_map: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "path_map", checked("path_map", self.path_map, None, 3))
