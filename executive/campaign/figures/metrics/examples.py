"""Whether the shipped examples did what their names say, by the simulator's truth."""

import itertools
from collections.abc import Callable, Mapping

import numpy as np

from executive.campaign.figures.metrics.inspect_and_confirm import is_confirmed, is_inspected
from executive.campaign.figures.metrics.report import stones
from executive.events.site import RegionNamed
from executive.events.stone import StoneReleased
from executive.geometry.polygon import outline_gap
from executive.interfaces.metric import Metric, RunRecord, Share
from executive.interfaces.truth import TrueStone
from executive.messages.region import Region

_ON_PLACE_M = 0.30  # from its slot, as `placed` counts
# Estimated volumes are off by some per cent: two stones so alike may stand in either row.
_ALIKE = 1.1
_NEXT_M = 0.25  # between faces of neighbours in a course that is to have 0.1 m
_GROUND = "terrain"


class AsNamed(Metric):
    """Whether an example did what its name says."""

    title = "examples that do what their name says"
    is_share = True
    description = (
        "Runs of the examples that ended in success and, by the simulator's truth, did what their"
        " name says. `sort`: each stone stands within 0.30 m of its place in a row, and none in the"
        " row of small stones has 1.1 times the volume of one in the other row. `clear_corridor`:"
        " no stone's outline from above comes into the region `corridor`. `two_courses`: each stone"
        " of the first course is 0.25 m or less from a neighbour, and every other stone is off the"
        " ground and touches two of them. `inspect`: the report lists each stone once, within 0.5 m"
        " of its true centre, and nothing else. `confirm`: no stone of 0.375 to 0.6 m³ was grasped"
        " without a yes to that attempt."
    )

    def measure(self, run: RunRecord) -> Share | None:
        judge = _JUDGES.get(run.report.mission)
        if judge is None or not stones(run):
            return None
        return Share(int(run.report.outcome == "success" and judge(run)), 1)


class FalseSuccess(Metric):
    """Successes of examples that the truth denies."""

    title = "examples that report a success which is none"
    is_share = True
    is_more_better = False
    description = (
        "Runs of the examples that ended in success although, by the simulator's truth, they did"
        " not do what their name says, out of all runs; see `as_named`."
    )

    def measure(self, run: RunRecord) -> Share | None:
        judge = _JUDGES.get(run.report.mission)
        if judge is None or not stones(run):
            return None
        return Share(int(run.report.outcome == "success" and not judge(run)), 1)


def is_sorted(run: RunRecord) -> bool:
    """Return whether two rows hold all stones, the larger ones in one of them."""
    volumes: dict[str, list[float]] = {}
    rows = _newest_rows(run)
    for stone in stones(run):
        error_m, row = stone.slot_error_m, _row_of(stone, rows)
        if row is None or error_m is None or error_m > _ON_PLACE_M:
            return False
        volumes.setdefault(row, []).append(stone.volume_m3)
    if len(volumes) != 2:  # all of one size: one row
        return len(volumes) == 1
    small, large = sorted(volumes.values(), key=lambda row: float(np.mean(row)))
    return max(small) < _ALIKE * min(large)


def is_corridor_clear(run: RunRecord) -> bool:
    """Return whether no stone comes into the region `corridor`."""
    named = (one.event for one in run.events if isinstance(one.event, RegionNamed))
    found = [Region(one.name, one.corners_map) for one in named if one.name == "corridor"]
    if not found:
        return False
    return not any(found[-1].touches(stone.outline_m) for stone in stones(run))


def has_two_courses(run: RunRecord) -> bool:
    """Return whether stones stand side by side, and all others rest on two of them."""
    found = stones(run)
    lower = [one for one in found if _GROUND in one.touches]
    upper = [one for one in found if _GROUND not in one.touches]
    if len(lower) < 2 or not upper:
        return False
    names = {f"stone_{one.id}" for one in lower}
    beside = all(
        min(outline_gap(one.outline_m, two.outline_m) for two in lower if two is not one) <= _NEXT_M
        for one in lower
    )
    return beside and all(len(names.intersection(one.touches)) >= 2 for one in upper)


def _row_of(stone: TrueStone, rows: Mapping[int, str]) -> str | None:
    return None if stone.held_object is None else rows.get(stone.held_object)


def _newest_rows(run: RunRecord) -> dict[int, str]:
    """Return the branch of the main tree that placed each object last, by its number."""
    return {
        one.event.stone: "/".join(itertools.islice(one.node.split("/"), 2))
        for one in run.events
        if isinstance(one.event, StoneReleased)
    }


_JUDGES: Mapping[str, Callable[[RunRecord], bool]] = {
    "sort": is_sorted,
    "clear_corridor": is_corridor_clear,
    "two_courses": has_two_courses,
    "inspect": is_inspected,
    "confirm": is_confirmed,
}
