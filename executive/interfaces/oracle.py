"""What a simulator knows and a mission must not: read after the run, by the report and by tests."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from executive.interfaces.robot import Robot
from executive.messages.base_state import BaseState
from executive.messages.placement import Slot
from executive.messages.stone import Stone


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
    """What a mission estimated, to be compared with the truth."""

    states: Sequence[BaseState]
    stones: Sequence[Stone]
    first_stones: Sequence[Stone]  # each as it was first seen
    slots: Mapping[int, Slot]  # by stone id, the slot on which the mission placed it
    attempts: Sequence[Attempt]


class Oracle(ABC):
    """The truth about a simulated run, installed as `executive.oracle.v1` by the robot's name."""

    @abstractmethod
    def __init__(self, robot: Robot) -> None: ...

    @abstractmethod
    def truth(self, view: MissionView) -> dict[str, Any]:
        """Return the report's `truth` section: `stones`, `grasps`, `collisions`, `estimate`."""
