"""What a simulator knows of a run: the section `truth` of its report.

An oracle makes it, and metrics read it; no plugin and no leaf sees it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from executive.arrays import Float


@dataclass(frozen=True, slots=True, eq=False)
class Nothing:
    """A part of the truth that there is nothing to say about; `{}` in the file."""

    def __bool__(self) -> Literal[False]:
        return False


@dataclass(frozen=True, slots=True, eq=False)
class Stance:
    """How near a machine on its legs came to tipping.

    Attributes:
        most_tilt_rad: Largest tilt of the chassis [rad].
        least_margin_m: How far the resultant of the legs' forces stayed inside the area of
            support [m]; at 0 the machine begins to tip.
    """

    most_tilt_rad: float
    least_margin_m: float


@dataclass(frozen=True, slots=True, eq=False)
class TrueStone:
    """A simulated stone at the end of a run.

    Attributes:
        id: Its number on the site, from 1.
        held_object: Its number in the object database; None if it was never found.
        slot_error_m: Horizontal distance from the middle of its slot [m]; None without a slot.
        database_error_m: How far its pose in the database is from where the stone's true motion
            has carried it since its newest model was seen [m]; None if it is not in there.
        database_error_rad: That as an angle [rad].
        models: How many models the database has had of it.
        volume_m3: Its volume [m³].
        centre_m: Its centre in the map [m], shape (3,).
        outline_m: Its convex outline from above, in the map [m], shape (N, 2).
        bottom_m: Height of its lowest point in the map [m].
        top_m: Height of its highest point in the map [m].
        touches: What it touches: other stones as `stone_2`, and `terrain`.
    """

    id: int
    held_object: int | None
    slot_error_m: float | None
    database_error_m: float | None
    database_error_rad: float | None
    models: int
    volume_m3: float
    centre_m: Float
    outline_m: Float
    bottom_m: float
    top_m: float
    touches: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class TrueStructure:
    """A structure as it really stands at the end of a run.

    Attributes:
        name: Its name.
        stones: Numbers on the site of the stones whose middles are over its foot.
        T_map_stones: Their poses, shape (4, 4) each; the origin of a stone is its centre.
        moved_m: How far each of these that was ever picked has moved since the end of the newest
            attempt at it [m].
        verdict: What a judge says of it, by name; None for what does not apply. Empty without a
            judge, and without a stone.
    """

    name: str
    stones: tuple[int, ...]
    T_map_stones: tuple[Float, ...]
    moved_m: tuple[float, ...]
    verdict: Mapping[str, float | None] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class TrueGrasp:
    """What became of an attempt at a stone.

    Attributes:
        object: Number of the stone in the object database.
        lifted: It left the ground.
        dropped: It was lifted, and then fell out of the jaws.
    """

    object: int
    lifted: bool
    dropped: bool


@dataclass(frozen=True, slots=True, eq=False)
class Collision:
    """A contact that should not be: the bodies, begin and end [s], the largest force [N]."""

    bodies: tuple[str, str]
    from_s: float
    to_s: float
    max_force_n: float


@dataclass(frozen=True, slots=True, eq=False)
class LimitUse:
    """How near the machine came to one of its limits.

    Attributes:
        kind: `position`, `speed` or `effort` of a joint of the arm, `flow` of the pump, as the
            speeds of all joints take it, or `tipping`: the moment that tips the machine over the
            one by which the weight of its own links holds it.
        of: The joint, `pump`, or the chassis.
        largest_share: The largest share of the limit; beyond 1 it was passed.
        at_s: When that was [s].
        times_beyond: How often it was passed.
        beyond_s: How long it was passed in all [s].
    """

    kind: str
    of: str
    largest_share: float
    at_s: float
    times_beyond: int
    beyond_s: float


@dataclass(frozen=True, slots=True, eq=False)
class PositionErrors:
    """Distances of estimated positions of the cabin from the true ones [m].

    Attributes:
        mean: Their mean.
        std: Their standard deviation.
        max: The largest.
        bias: Length of the mean offset.
        component_std: Standard deviation of a component, the mean of all three.
    """

    mean: float
    std: float
    max: float
    bias: float
    component_std: float


@dataclass(frozen=True, slots=True, eq=False)
class AngleErrors:
    """Angles of estimated rotations of the cabin from the true ones [rad]."""

    mean: float
    std: float
    max: float


@dataclass(frozen=True, slots=True, eq=False)
class EstimateErrors:
    """Errors of the estimated pose of the cabin over a run."""

    error_m: PositionErrors
    error_rad: AngleErrors


@dataclass(frozen=True, slots=True, eq=False)
class KnownObjects:
    """How the object database knows the site.

    Attributes:
        stones: Number of stones of the site.
        known: Number of those that are in the database.
        twice: Number of objects that are a stone which another object stands for already.
        ghosts: Number of objects that were found where no stone was.
    """

    stones: int
    known: int
    twice: int
    ghosts: int


@dataclass(frozen=True, slots=True, eq=False)
class Realignment:
    """The pose of a known stone after a release.

    Attributes:
        stone: Number of the stone on the site.
        round: Number of its release, from 1.
        was_realigned: The pose was corrected on the new map.
        settled_error_m: Error of the pose that follows from the gripper's motion [m].
        settled_error_rad: That as an angle [rad].
        error_m: Error after the first correction [m]; as before where there was none.
        error_rad: That as an angle [rad].
    """

    stone: int
    round: int
    was_realigned: bool
    settled_error_m: float
    settled_error_rad: float
    error_m: float
    error_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Distances:
    """Distances of many points [m]: the median, and the 95th percentile."""

    median: float
    p95: float


@dataclass(frozen=True, slots=True, eq=False)
class MapErrors:
    """How far the points of the map at the end are from the true surface at that time.

    Attributes:
        distance_m: Distances of the points to it, which have no sign.
        bias_m: Mean of the signed distances of points within 0.5 m, positive outside of ground and
            stones [m]; None without such points.
        std_m: Standard deviation of the same [m]; None without such points.
    """

    distance_m: Distances
    bias_m: float | None
    std_m: float | None


@dataclass(frozen=True, slots=True, eq=False)
class RegistrationErrors:
    """How far the registered survey is from where the whole fits the true surface best.

    Attributes:
        error_m: Distance of its middle [m].
        error_rad: Angle [rad].
    """

    error_m: float
    error_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """What a simulator knows of a run; None where an oracle does not observe it.

    Attributes:
        scenario: Kind of the physics: `nominal`, `wet` or `harsh`.
        stance: How a machine on its legs stood; nothing of one that is welded to the ground.
        stones: The stones of the site.
        grasps: One for each attempt, in order of time.
        collisions: Contacts that should not be.
        ground_contacts: How often gripper or jaws touched the ground, which is no collision.
        estimate: Errors of the estimated cabin; nothing without an estimate.
        objects: How the object database knows the site; nothing without one.
        realignments: One for each release of a known stone.
        map: Errors of the map; nothing without a map.
        registration: Errors of the registered survey; nothing without one.
        limits: How near the machine came to each of its limits.
        structures: What was built of stones, as it stands.
    """

    scenario: str
    stance: Nothing | Stance
    stones: tuple[TrueStone, ...]
    grasps: tuple[TrueGrasp, ...] | None
    collisions: tuple[Collision, ...] | None
    ground_contacts: int | None
    estimate: Nothing | EstimateErrors
    objects: Nothing | KnownObjects
    realignments: tuple[Realignment, ...] | None
    map: Nothing | MapErrors
    registration: Nothing | RegistrationErrors
    limits: tuple[LimitUse, ...] | None
    structures: tuple[TrueStructure, ...] = ()
