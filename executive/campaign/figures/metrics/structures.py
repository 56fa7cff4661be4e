"""Metrics of structures that a mission has built of found stones."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from executive.arrays import Float
from executive.campaign.figures.metrics.report import stones
from executive.events.site import BuildingEnded, BuildingPlanned
from executive.events.stone import PlacementVerified, StoneRealigned, StoneReleased
from executive.geometry.rotation import angle_between
from executive.interfaces.metric import Metric, RunRecord, Share, Values

_RIGHT_M, _RIGHT_RAD = 0.10, math.radians(10.0)  # of the plan: a stone that is where it was wanted
_NO_ENDS = frozenset({"stale_map", "out_of_time"})
_TIMING = "building.propose"
_SEEN = (
    " of a stone from where it was planned, as the look after its release has seen it, for each"
    " release on a structure that was followed by such a look"
)


@dataclass(slots=True)
class _Release:
    """A release on a structure, and what the look after it has shown."""

    planned_pose: Float
    realigned_pose: Float | None = None
    verified: PlacementVerified | None = None

    @property
    def off_m(self) -> float | None:
        """Distance from the plan [m]; None if the stone was not seen."""
        return None if self.verified is None else self.verified.off_m

    @property
    def off_rad(self) -> float | None:
        """Angle from the plan [rad]; the tilt alone where the stone was not aligned."""
        if self.verified is None or self.verified.off_m is None:
            return None
        if self.realigned_pose is None or not self.verified.turn_known:
            return self.verified.tilt_rad
        return angle_between(self.planned_pose[:3, :3], self.realigned_pose[:3, :3])


class StonesBuilt(Metric):
    """Stones that stand in a structure."""

    title = "stones of a structure"
    description = (
        "Number of stones in a run that stand in a structure at the end, as the mission knows it:"
        " those with which it was planned or ended last, and one that was placed after that."
    )

    def measure(self, run: RunRecord) -> Values | None:
        standing = _standing(run)
        return None if standing is None else Values((len(standing),))


class StandingError(Metric):
    """Distance of each stone of a structure from where it is known to stand."""

    title = "position error of stones of a structure"
    unit = "m"
    is_more_better = False
    description = (
        "Distance of the pose in the object database at the end from the true one, of each stone"
        " that stands in a structure (`stones_built`). What a later stone has pushed unnoticed is"
        " off by so much."
    )

    def measure(self, run: RunRecord) -> Values | None:
        standing = _standing(run)
        if standing is None or run.report.truth is None:
            return None
        errors = (one.database_error_m for one in stones(run) if one.held_object in standing)
        return Values(tuple(error for error in errors if error is not None))


class BuiltAsPlanned(Metric):
    """Releases after which the stone is where it was planned."""

    title = "stones that settle as planned"
    is_share = True
    description = (
        f"Releases on a structure after which the stone is seen within {_RIGHT_M:.2f} m and"
        f" {math.degrees(_RIGHT_RAD):.0f}° of where it was planned, out of all releases on a"
        " structure. A stone that was not seen again is not as planned."
    )

    def measure(self, run: RunRecord) -> Share | None:
        found = _releases(run)
        return Share(sum(_is_right(one) for one in found), len(found)) if found else None


class BuiltError(Metric):
    """Distance of each stone of a structure from its plan."""

    title = "settled against planned, distance"
    unit = "m"
    is_more_better = False
    description = f"Distance of the middle{_SEEN}."

    def measure(self, run: RunRecord) -> Values | None:
        found = _releases(run)
        return Values(tuple(x for one in found if (x := one.off_m) is not None)) if found else None


class BuiltRotationError(Metric):
    """Angle of each stone of a structure from its plan."""

    title = "settled against planned, angle"
    unit = "rad"
    is_more_better = False
    description = (
        f"Angle{_SEEN}; the tilt alone of one that was found by another way than by aligning its"
        " model with the scan."
    )

    def measure(self, run: RunRecord) -> Values | None:
        found = _releases(run)
        angles = (one.off_rad for one in found)
        return Values(tuple(x for x in angles if x is not None)) if found else None


class StructureEnded(Metric):
    """Whether structures came to an end of their own."""

    title = "structures that come to an end"
    is_share = True
    description = (
        "Structures whose building ended because they are complete, or because no stone that is"
        " left can be added, out of all that were begun. One that ended with `stale_map` or"
        " `out_of_time`, or with the mission, did not."
    )

    def measure(self, run: RunRecord) -> Share | None:
        of_each: dict[str, bool] = {}
        for one in run.events:
            match one.event:
                case BuildingPlanned() as event:
                    of_each[event.structure] = False
                case BuildingEnded() as event:
                    of_each[event.structure] = event.reason not in _NO_ENDS
        return Share(sum(of_each.values()), len(of_each)) if of_each else None


class BuildingTime(Metric):
    """Time to plan a stone of a structure."""

    title = "planning a stone of a structure, median of a run"
    unit = "s"
    is_more_better = False
    description = (
        "Wall time that the building planner takes for an answer: the median of a run. It depends"
        " on what else the computer does."
    )

    def measure(self, run: RunRecord) -> Values | None:
        timing = run.report.timings_ms.get(_TIMING)
        return None if timing is None else Values((timing.median / 1000,))


class BuildingTimeP95(Metric):
    """Time to plan a stone of a structure, the slow ones."""

    title = "planning a stone of a structure, 95th percentile of a run"
    unit = "s"
    is_more_better = False
    description = (
        "Wall time that the building planner takes for an answer: the 95th percentile of a run. It"
        " depends on what else the computer does."
    )

    def measure(self, run: RunRecord) -> Values | None:
        timing = run.report.timings_ms.get(_TIMING)
        return None if timing is None else Values((timing.p95 / 1000,))


def _standing(run: RunRecord) -> frozenset[int] | None:
    """Return the ids of the stones that stand in structures; None without any structure.

    They are those of which the newest plan of each structure says so, and those that were placed
    after it.
    """
    planned: set[int] = set()
    standing: dict[str, tuple[int, ...]] = {}
    since: dict[str, float] = {}
    for one in run.events:
        match one.event:
            case BuildingPlanned() as event:
                planned.add(event.stone)
                standing[event.structure], since[event.structure] = event.standing, one.time_s
            case BuildingEnded() as event:
                standing[event.structure], since[event.structure] = event.standing, one.time_s
    if not standing:
        return None
    seen = (one.event.stone for one in run.events if isinstance(one.event, PlacementVerified)
            and one.event.seen == "placed" and one.time_s >= max(since.values()))  # fmt: skip
    return frozenset().union(*standing.values(), planned.intersection(seen))


def _releases(run: RunRecord) -> Sequence[_Release]:
    """Return the releases of stones that were planned for a structure, in order of time."""
    found: list[_Release] = []
    newest: dict[int, _Release] = {}
    planned: set[int] = set()
    for one in run.events:
        match one.event:
            case BuildingPlanned() as event:
                planned.add(event.stone)
            case StoneReleased() as event if event.stone in planned:
                newest[event.stone] = _Release(event.planned_pose)
                found.append(newest[event.stone])
            case StoneRealigned() as event if event.stone in newest and event.accepted:
                newest[event.stone].realigned_pose = event.estimated_pose
            case PlacementVerified() as event if event.stone in newest:
                newest.pop(event.stone).verified = event
    return found


def _is_right(release: _Release) -> bool:
    off_m, off_rad = release.off_m, release.off_rad
    if off_m is None or off_rad is None:
        return False
    return off_m <= _RIGHT_M and off_rad <= _RIGHT_RAD
