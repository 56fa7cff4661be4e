"""Events about one stone: attempts, the grasp, the release, the realignment, giving up."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive.arrays import Float
from executive.events.event import Event


@dataclass(frozen=True, slots=True, eq=False)
class GraspsPlanned(Event):
    """Grasps were planned for a stone.

    Attributes:
        stone: Id of the stone.
        grasps: Number of grasps.
        refused: Number of refused hypotheses by reason.
    """

    stone: int
    grasps: int
    refused: Mapping[str, int]


@dataclass(frozen=True, slots=True, eq=False)
class GraspRecord:
    """The grasp of an attempt: pose (4, 4), opening of the tips [m], score and its terms."""

    T_map_gripper: Float
    opening_m: float
    score: float
    costs: Mapping[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class AttemptStarted(Event):
    """A grasp with a collision-free path was chosen, and the gripper goes there.

    Attributes:
        stone: Id of the stone.
        centroid_map: Estimated centroid of the stone [m], shape (3,).
        grasp: The grasp.
        passed_over: Why better grasps were passed over: no path was found to them.
        success: Expected chance that the attempt places the stone, 0 to 1, after what came of those
            before it on the site; None if nothing tells how often the grasp holds.
    """

    stone: int
    centroid_map: Float
    grasp: GraspRecord
    passed_over: tuple[str, ...]
    success: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class JawsClosedOnNothing(Event):
    """The jaws closed without holding anything."""

    stone: int
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class StoneGrasped(Event):
    """The jaws closed on a stone, and its place was removed from the map.

    Attributes:
        stone: Id of the stone.
        jaw_rad: Angle of the jaws [rad].
        removed_points: Points that were removed from the map.
        put_back_points: Points of neighbouring stones that were put back.
    """

    stone: int
    jaw_rad: float
    removed_points: int
    put_back_points: int


@dataclass(frozen=True, slots=True, eq=False)
class ArrivedEarly(Event):
    """A motion with a held stone was cut short near enough to its placement, or straight above it.

    Attributes:
        aside_m: Horizontal distance from the placement [m].
        above_m: Height above it [m].
    """

    aside_m: float
    above_m: float


@dataclass(frozen=True, slots=True, eq=False)
class StoneNotLifted(Event):
    """A stone that was lifted by a little for a trial still stands with a part of its weight.

    Attributes:
        stone: Id of the stone.
        up_m: Height of the gripper above the grasp [m].
        hanging_kg: What hangs in the jaws [kg].
        least_kg: Mass from which it would have been taken to hang free [kg].
        higher_kg: What hung in the jaws as it was raised on [kg]; None if it was not.
        tipping_kg: Load that tips the machine there, if the lift was stopped before that [kg].
        most_kg: Mass above which it is not that stone alone, if so much more hangs [kg].
    """

    stone: int
    up_m: float
    hanging_kg: float
    least_kg: float
    higher_kg: float | None = None
    tipping_kg: float | None = None
    most_kg: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class StoneTouchedDown(Event):
    """A stone that was lowered stands: its weight has left the jaws.

    Attributes:
        stone: Id of the stone.
        above_m: Height of the gripper above the placement [m]; below 0 if the ground is lower.
        left_kg: What still hangs in the jaws [kg].
    """

    stone: int
    above_m: float
    left_kg: float


@dataclass(frozen=True, slots=True, eq=False)
class StoneReleased(Event):
    """A stone was set down on its slot.

    Attributes:
        stone: Id of the stone.
        slot: Number of the slot.
        slot_position: The slot's point on the ground [m], shape (3,).
        planned_pose: Planned T_map_object, shape (4, 4).
        estimated_pose: T_map_object by the gripper's motion (Mascaro 2020, Eq. 3), shape (4, 4).
    """

    stone: int
    slot: int
    slot_position: Float
    planned_pose: Float
    estimated_pose: Float


@dataclass(frozen=True, slots=True, eq=False)
class StoneWeighed(Event):
    """A stone was weighed while it was carried.

    Attributes:
        stone: Id of the stone.
        mass_kg: Its mass [kg].
        std_kg: Standard deviation of the mass [kg].
    """

    stone: int
    mass_kg: float
    std_kg: float


@dataclass(frozen=True, slots=True, eq=False)
class StoneSeenInJaws(Event):
    """A held stone was looked at, and its pose in the jaws corrected or kept.

    Attributes:
        stone: Id of the stone.
        accepted: Whether its pose was corrected.
        reason: Why the expected pose was kept; empty if it was corrected.
        points: Points of the view, one a voxel of the map.
        shift_m: Distance of its centre from where it was expected [m]; None if it was kept.
        turn_rad: Its turn against what was expected [rad]; None if it was kept.
        position_std_m: Standard deviation of its position along the least certain axis [m]; None
            if it was kept.
        rotation_std_rad: The same of its rotation [rad]; None if it was kept.
        refused: Why the stone is not carried on as it lies in the jaws; empty if it is.
    """

    stone: int
    accepted: bool
    reason: str
    points: int
    shift_m: float | None
    turn_rad: float | None
    position_std_m: float | None
    rotation_std_rad: float | None
    refused: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class StoneSeenFromBelow(Event):
    """A held stone was raised above the lidars, and its underside looked at.

    Attributes:
        stone: Id of the stone.
        accepted: Whether what was seen took the place of the lower half of its model.
        points: Points of the view, one a voxel of the map.
        seen: Share of the columns of 0.1 m through the stone in which its lower half was seen.
        raised_m: By how much its lowest point is higher than that of the model before [m].
    """

    stone: int
    accepted: bool
    points: int
    seen: float
    raised_m: float


@dataclass(frozen=True, slots=True, eq=False)
class PlacementVerified(Event):
    """A released stone was looked for at its place.

    Attributes:
        stone: Id of the stone.
        slot: Number of the slot.
        seen: `placed` if it stands there within the mission's tolerance, `off` if it does not,
            `unseen` if it was not recognised.
        off_m: Distance of its centre from the plan [m]; None if it is unseen.
        tilt_rad: Tilt against the plan [rad]; None if it is unseen.
        rule: What the mission does with a stone that is off or unseen: correct, keep, set_aside;
            empty if it is placed.
        reason: What is wrong; empty if it is placed.
        turn_known: Whether its pose tells how it is turned against the stone as it was found. False
            once it was seen with another surface, which took the place of the model: it stands as
            planned by that surface, and how it had turned before is not known.
    """

    stone: int
    slot: int
    seen: str
    off_m: float | None
    tilt_rad: float | None
    rule: str
    reason: str
    turn_known: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class StoneLetGo(Event):
    """A stone was released where it was, without a placement; its pose is an estimate, (4, 4)."""

    stone: int
    estimated_pose: Float


@dataclass(frozen=True, slots=True, eq=False)
class PlaceForgotten(Event):
    """A stone's place was removed from the map, for the next scan to show it."""

    stone: int
    removed_points: int
    put_back_points: int


@dataclass(frozen=True, slots=True, eq=False)
class StoneRealigned(Event):
    """A relocated stone's pose was corrected on the map, or the correction was refused.

    Attributes:
        stone: Id of the stone.
        accepted: Whether the pose was corrected.
        method: `alignment` or `registration`.
        reason: Why it was refused; empty if it was accepted.
        rmse_m: Root mean square distance of corresponding points [m].
        overlap: Share of the model's points with a partner in the map.
        estimated_pose: T_map_object afterwards, shape (4, 4).
    """

    stone: int
    accepted: bool
    method: str
    reason: str
    rmse_m: float
    overlap: float
    estimated_pose: Float


@dataclass(frozen=True, slots=True, eq=False)
class StoneSoughtAgain(Event):
    """A stone that was dropped or missed was looked for in the map.

    Attributes:
        stone: Id of the stone.
        seen: Ids of the stones that were seen there.
        method: `registration` or `segmentation`.
        reason: What registration answered.
    """

    stone: int
    seen: tuple[int, ...]
    method: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class StoneLost(Event):
    """A stone is not where it was believed to be: it fell, or a look did not show it.

    Attributes:
        stone: Id of the stone.
        reason: What is known of it.
    """

    stone: int
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class StoneSetAside(Event):
    """A stone was set aside: it stays where it is, unless `TakeUpAgain` takes it up later."""

    stone: int
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class StonesTakenUpAgain(Event):
    """Stones that were set aside may be attempted again."""

    stones: tuple[int, ...]
