"""Events by which a mission tells what it found: marks, figures, lists of stones, saved maps."""

from dataclasses import dataclass
from typing import Literal

from executive.arrays import Float
from executive.events.event import Event


@dataclass(frozen=True, slots=True, eq=False)
class Marked(Event):
    """A place was marked with a text.

    Attributes:
        text: What is said about it.
        kind_of_place: What was marked.
        position_map: The point, the stone's centroid or the middle of the region [m], shape (3,).
        stone: Id of the stone, if one was marked.
        region: Name of the region, if one was marked.
    """

    text: str
    kind_of_place: Literal["point", "stone", "region"]
    position_map: Float
    stone: int | None = None
    region: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class FigureReported(Event):
    """A number with a name, for the report and for campaigns.

    Attributes:
        name: Its name; the newest figure of a name counts.
        value: The number, in its unit.
        unit: The unit; empty for a plain number.
    """

    name: str
    value: float
    unit: str


@dataclass(frozen=True, slots=True, eq=False)
class ListedStone:
    """A stone as the database knows it.

    Attributes:
        id: Its number.
        state: Its state, such as `on_ground`.
        centroid_map: Mean of its points [m], shape (3,).
        extents_m: Its extents along the axes of the map, as far as it was seen [m], shape (3,).
        points: Number of points of its model.
        volume_m3: Volume of its convex hull [m³]; None if too little of it was seen.
    """

    id: int
    state: str
    centroid_map: Float
    extents_m: Float
    points: int
    volume_m3: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class StonesListed(Event):
    """The stones of the database were written into the report; a later list replaces it."""

    stones: tuple[ListedStone, ...]


@dataclass(frozen=True, slots=True, eq=False)
class MapSaved(Event):
    """The map was written to a file.

    Attributes:
        file: Its path; relative to the run's folder if it is in there.
        points: Number of points.
        frame: Frame of the points.
        T_map_base: Pose of the chassis at that moment, shape (4, 4).
        datum: Where the frame's origin is: latitude [deg], longitude [deg], altitude above the
            ellipsoid [m]; None if nobody knows.
    """

    file: str
    points: int
    frame: str
    T_map_base: Float
    datum: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class MapLoaded(Event):
    """A cloud was read from a file.

    Attributes:
        file: Its path.
        points: Number of points.
        frame: Frame of the points.
        is_merged: Whether its points were put into the map.
    """

    file: str
    points: int
    frame: str
    is_merged: bool
