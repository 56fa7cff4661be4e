"""What a simulator knows and a mission must not: read after the run, by the report and by tests."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from executive.interfaces.robot import Robot
from executive.interfaces.truth import Truth
from executive.messages.base_state import BaseState
from executive.messages.building import AsBuilt
from executive.messages.cloud import Cloud
from executive.messages.placement import Slot
from executive.messages.stone import Stone
from executive.messages.stone_event import StoneEvent
from executive.messages.structure import Structure


@dataclass(frozen=True, slots=True, eq=False)
class Attempt:
    """One try at one stone, as the mission saw it: who, when, how it ended."""

    stone_id: int
    started_s: float
    ended_s: float
    outcome: str
    grasp_centroid_map: tuple[float, float, float]  # estimated place of the stone at the start


@dataclass(frozen=True, slots=True, eq=False)
class MissionView:
    """What a mission estimated, to be compared with the truth.

    Attributes:
        states: Estimated states, about one a second.
        stones: The objects of the database at the end.
        slots: The slot on which the mission placed each stone, by the stone's id.
        attempts: All attempts at stones in order of time.
        histories: What happened to each object of the database, oldest first, by its id; None
            without a database.
        map_cloud: The map at the end, in the frame `map`; None without a mapper.
        registered_survey: The survey as the last accepted registration lays it over the map; None
            without one.
        structures: What was to be built of stones, of each structure that was ended.
    """

    states: Sequence[BaseState]
    stones: Sequence[Stone]
    slots: Mapping[int, Slot]
    attempts: Sequence[Attempt]
    histories: Mapping[int, Sequence[StoneEvent]] | None = None
    map_cloud: Cloud | None = None
    registered_survey: Cloud | None = None
    structures: Sequence[Structure] = ()


class Witness(ABC):
    """A simulated robot that can leave its truth in a file, for an oracle in another process."""

    @abstractmethod
    def write_truth(self, path: Path) -> None:
        """Write what has happened since the start, whole or not at all.

        Raises:
            OSError: If the file cannot be written.
        """

    @abstractmethod
    def read_truth(self, path: Path, zero_s: float) -> None:
        """Take the truth of an equal robot, made from equal settings and an equal seed.

        Args:
            path: What `write_truth` wrote.
            zero_s: The time of that robot's clock that is taken as zero [s].

        Raises:
            DataError: If the file is missing, damaged, or of another site.
        """


class Oracle(ABC):
    """The truth about a simulated run, installed as `executive.oracle.v1` by the robot's name."""

    @abstractmethod
    def __init__(self, robot: Robot) -> None: ...

    @abstractmethod
    def truth(self, view: MissionView) -> Truth:
        """Return what really happened in the run, for its report."""

    def as_built(self, structure: Structure) -> AsBuilt | None:
        """Return a structure with the stones that really stand in it, for a judge.

        Their shapes are those by which they touch. By default nobody knows: None.
        """
        return None
