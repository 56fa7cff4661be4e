"""Events about the site: localisation, scans, the drone's map, segmentation, places for stones."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from executive.arrays import Float
from executive.events.event import Event
from executive.messages.structure import Structure


@dataclass(frozen=True, slots=True, eq=False)
class RegionNamed(Event):
    """A region of the mission: its name, and the corners of its outline [m], shape (N, 2)."""

    name: str
    corners_map: Float


@dataclass(frozen=True, slots=True, eq=False)
class Localised(Event):
    """The state estimate became usable: T_map_base, shape (4, 4)."""

    T_map_base: Float
    status: str


@dataclass(frozen=True, slots=True, eq=False)
class SiteSurveyed(Event):
    """A survey from outside, such as a drone's, gave a cloud of so many points."""

    points: int


@dataclass(frozen=True, slots=True, eq=False)
class SiteScanned(Event):
    """A swing with the lidars on has ended; the map holds so many points."""

    points: int


@dataclass(frozen=True, slots=True, eq=False)
class MapDense(Event):
    """The map shows enough of the region to be segmented.

    Attributes:
        waited_s: Time since the leaf began [s].
        share: Share of the region's square metres that are dense enough.
        points: Points of the map.
    """

    waited_s: float
    share: float
    points: int


@dataclass(frozen=True, slots=True, eq=False)
class SurveyRegistered(Event):
    """The survey was registered on the map, or refused.

    Attributes:
        accepted: Whether the registration's own test accepted it.
        reason: Why, with its figures.
        rmse_m: Root mean square distance of corresponding points [m].
        overlap: Share of the survey's points with a partner in the map.
        scale: Factor from the survey's unit to metres.
        matched_segments: Number of segments that agree.
        T_map_survey: The transform, shape (4, 4).
    """

    accepted: bool
    reason: str
    rmse_m: float
    overlap: float
    scale: float
    matched_segments: int
    T_map_survey: Float


@dataclass(frozen=True, slots=True, eq=False)
class SurveyFitted(Event):
    """The registered survey was laid onto the map from place to place, before both were merged.

    Attributes:
        share: Share of the survey that the map shows, too.
        median_m: Median length of the shifts [m].
        largest_m: Largest length [m].
    """

    share: float
    median_m: float
    largest_m: float


@dataclass(frozen=True, slots=True, eq=False)
class PartLeftOut:
    """A part that rises from the ground and is no stone.

    Attributes:
        kind: What it is taken for, such as `stack` or `structure`.
        reason: What was measured, and the limit.
        points: Number of its points.
        centroid_map: Their mean [m], shape (3,).
    """

    kind: str
    reason: str
    points: int
    centroid_map: Float


@dataclass(frozen=True, slots=True, eq=False)
class SiteSegmented(Event):
    """The map was segmented.

    Attributes:
        stones: Ids of the stones seen.
        points: Points of each one's model.
        left_out: What rises from the ground and is no stone, the part of most points first.
        scattered_points: Points above the ground in clusters too small to be named.
        warnings: What speaks against the map being a site in metres with z up.
    """

    stones: tuple[int, ...]
    points: tuple[int, ...]
    left_out: tuple[PartLeftOut, ...] = ()
    scattered_points: int = 0
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class SlotPlace:
    """A slot's number and its point on the ground [m], shape (3,)."""

    slot: int
    position_map: Float


@dataclass(frozen=True, slots=True, eq=False)
class SlotsFound(Event):
    """The placement planner chose these places for stones, best first."""

    slots: tuple[SlotPlace, ...]


@dataclass(frozen=True, slots=True, eq=False)
class BuildingPlanned(Event):
    """The next stone of a structure was chosen, with the pose in which it is to rest.

    Attributes:
        structure: Name of the structure.
        stone: Id of the stone.
        T_map_object: Pose of the stone's object frame at rest, shape (4, 4).
        standing: Ids of the stones that it was planned with, as they stood.
        worst_m: Largest distance from that rest in the planner's trials under noise [m].
        score: The planner's score.
        terms: Its terms by name.
        refused: Number of stones and places that were passed over, by reason.
    """

    structure: str
    stone: int
    T_map_object: Float
    standing: tuple[int, ...]
    worst_m: float
    score: float
    terms: Mapping[str, float]
    refused: Mapping[str, int]


@dataclass(frozen=True, slots=True, eq=False)
class BuildingEnded(Event):
    """No other stone is put onto a structure.

    Attributes:
        structure: Name of the structure.
        reason: Why: `complete`, `nothing_fits`, `no_stones`, `all_too_heavy` and so on.
        detail: The figures behind the reason, in words.
        standing: Ids of the stones of which it consists.
        refused: Number of stones and places that were passed over, by reason.
        by_stone: The same of each stone that is left, by its id; the reasons of its best places
            come first.
        shape: What was to be built; None in the journals of older versions.
    """

    structure: str
    reason: str
    detail: str
    standing: tuple[int, ...]
    refused: Mapping[str, int]
    by_stone: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    shape: Structure | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PlaceNotFound(Event):
    """A structure as it stands has no place for one stone; it may have one later.

    Attributes:
        structure: Name of the structure.
        stone: Id of the stone.
        is_held: Whether the jaws hold it: places are those in which they can let it go, too.
        reason: Why: `nothing_fits`, `out_of_time`, `all_too_heavy` and so on.
        refused: Number of its places that were passed over, by reason.
    """

    structure: str
    stone: int
    is_held: bool
    reason: str
    refused: Mapping[str, int]


@dataclass(frozen=True, slots=True, eq=False)
class RoundBegun(Event):
    """A new round of relocations began: these placed stones may be moved again."""

    stones: tuple[int, ...]
