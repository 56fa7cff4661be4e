"""Metrics of durations on the mission's clock, of a mission as a whole and by phase."""

from collections.abc import Iterator

from executive.events.event import Event
from executive.events.node import NodeStarted
from executive.events.site import SiteScanned, SiteSegmented
from executive.events.stone import (
    AttemptStarted,
    GraspsPlanned,
    StoneGrasped,
    StoneRealigned,
    StoneReleased,
)
from executive.interfaces.metric import Metric, RunRecord, TimedEvent, Values


class _Duration(Metric):
    """A duration [s]; less is better."""

    unit = "s"
    is_more_better = False


class MissionTime(_Duration):
    """Duration of the mission."""

    title = "mission time"
    description = "Mission time from the start to the end, however the mission ended."

    def measure(self, run: RunRecord) -> Values:
        return Values((run.report.ended_s - run.report.started_s,))


class CycleTime(_Duration):
    """Duration of each relocation."""

    title = "cycle time"
    description = (
        "Mission time from the choice of the first grasp for a stone to its release at a slot, with"
        " all attempts in between, for each relocation that ended in a release."
    )

    def measure(self, run: RunRecord) -> Values:
        placed = [pick.attempts for pick in run.report.picks if pick.placed]
        return Values(tuple(tries[-1].ended_s - tries[0].started_s for tries in placed))


class MappingTime(_Duration):
    """Time until the stones are found."""

    title = "phase: mapping, until the stones are found"
    description = (
        "Mission time from the start to the first segmentation of the map: localising, surveying,"
        " scanning and registering."
    )

    def measure(self, run: RunRecord) -> Values:
        return Values(tuple(_times(run, SiteSegmented)[:1]))


class ScanTime(_Duration):
    """Duration of each swing with the lidars on."""

    title = "phase: a scan"
    description = "Mission time of each swing with the lidars on, from its start to its end."

    def measure(self, run: RunRecord) -> Values:
        started_s: dict[str, float] = {}
        durations: list[float] = []
        for one in run.events:
            if isinstance(one.event, NodeStarted):
                started_s[one.node] = one.time_s
            elif isinstance(one.event, SiteScanned) and one.node in started_s:
                durations.append(one.time_s - started_s[one.node])
        return Values(tuple(durations))


class PlanTime(_Duration):
    """Time to plan each pick."""

    title = "phase: planning a pick"
    description = (
        "Mission time from when the planning of a stone's grasps begins to the choice of a grasp"
        " that a path leads to; for a further grasp of the same plan, of that choice alone."
    )

    def measure(self, run: RunRecord) -> Values:
        started_s: dict[str, float] = {}
        begun_s: float | None = None
        durations: list[float] = []
        for one in run.events:
            match one.event:
                case NodeStarted():
                    started_s[one.node] = one.time_s
                case GraspsPlanned() if one.node in started_s:
                    begun_s = started_s[one.node]
                case AttemptStarted():
                    from_s = started_s.get(one.node) if begun_s is None else begun_s
                    durations += [] if from_s is None else [one.time_s - from_s]
                    begun_s = None
        return Values(tuple(durations))


class ReachTime(_Duration):
    """Time from the choice of a grasp to holding the stone."""

    title = "phase: reaching and grasping"
    description = (
        "Mission time from the choice of a grasp to when the jaws have closed on the stone, for"
        " each attempt that came so far."
    )

    def measure(self, run: RunRecord) -> Values:
        return Values(tuple(_between(run, AttemptStarted, StoneGrasped)))


class CarryTime(_Duration):
    """Time from holding the stone to its release."""

    title = "phase: carrying and releasing"
    description = (
        "Mission time from when the jaws have closed on a stone to its release at a slot, the"
        " planning of the placement included."
    )

    def measure(self, run: RunRecord) -> Values:
        return Values(tuple(_between(run, StoneGrasped, StoneReleased)))


class RealignTime(_Duration):
    """Time from the release to the corrected pose."""

    title = "phase: looking at the placed stone"
    description = (
        "Mission time from the release of a stone to when its pose is corrected on the new map, or"
        " the correction refused: lifting off, scanning, aligning."
    )

    def measure(self, run: RunRecord) -> Values:
        return Values(tuple(_between(run, StoneReleased, StoneRealigned)))


def _times(run: RunRecord, kind: type[Event]) -> list[float]:
    return [one.time_s for one in run.events if isinstance(one.event, kind)]


def _between(run: RunRecord, first: type[Event], last: type[Event]) -> Iterator[float]:
    """Yield the time from an event to the next one of another kind, about the same stone."""
    begun: TimedEvent | None = None
    for one in run.events:
        if isinstance(one.event, first):
            begun = one
        elif isinstance(one.event, last) and begun is not None:
            if _stone(one.event) == _stone(begun.event):
                yield one.time_s - begun.time_s
            begun = None


def _stone(event: Event) -> int | None:
    return getattr(event, "stone", None)
