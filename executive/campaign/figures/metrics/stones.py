"""Metrics of the stones at their slots, by the simulator's truth."""

from executive.campaign.figures.metrics.report import stones
from executive.interfaces.metric import Metric, RunRecord, Share, Values
from executive.interfaces.report import PickReport
from executive.interfaces.truth import TrueStone
from executive.mission.report import NEAR_M


class Placed(Metric):
    """Stones near their slot at the end."""

    title = "stones placed"
    is_share = True
    description = (
        f"Stones whose middle is within {NEAR_M:.2f} m, horizontally, of the middle of the slot"
        " that the mission gave them, by the simulator's truth at the end, out of all stones of the"
        " site. A stone that was never found, never picked or set aside is not placed."
    )

    def measure(self, run: RunRecord) -> Share | None:
        found = stones(run)
        return Share(sum(_is_near(one) for one in found), len(found)) if found else None


class FirstAttempt(Metric):
    """Stones that the first attempt has placed."""

    title = "stones placed at the first attempt"
    is_share = True
    description = (
        "Stones whose first relocation took one attempt from choosing a grasp to the release at a"
        f" slot, and that are within {NEAR_M:.2f} m of their slot by the truth at the end, out of"
        " all stones of the site."
    )

    def measure(self, run: RunRecord) -> Share | None:
        return _placed_within(run, 1)


class WithinThree(Metric):
    """Stones that one of the first three attempts has placed."""

    title = "stones placed within three attempts"
    is_share = True
    description = (
        "Stones whose first relocation took three attempts at most, counted as those of"
        f" `first_attempt`, and that are within {NEAR_M:.2f} m of their slot by the truth at the"
        " end, out of all stones of the site."
    )

    def measure(self, run: RunRecord) -> Share | None:
        return _placed_within(run, 3)


class PlacementError(Metric):
    """Distance of each placed stone from its slot."""

    title = "placement error"
    unit = "m"
    is_more_better = False
    description = (
        "Horizontal distance of a stone's middle from the middle of its slot, by the simulator's"
        " truth at the end, for each stone that the mission released at a slot, near or not."
    )

    def measure(self, run: RunRecord) -> Values | None:
        errors = [one.slot_error_m for one in stones(run)]
        return Values(tuple(error for error in errors if error is not None)) if errors else None


class Attempts(Metric):
    """Attempts that each relocation took."""

    title = "attempts a relocation"
    is_more_better = False
    description = (
        "Number of attempts of each relocation of a stone, whether it ended at a slot or not; an"
        " attempt begins with the choice of a grasp that a path leads to."
    )

    def measure(self, run: RunRecord) -> Values | None:
        picks = run.report.picks
        return Values(tuple(len(pick.attempts) for pick in picks)) if picks else None


def _is_near(stone: TrueStone) -> bool:
    error = stone.slot_error_m
    return error is not None and error <= NEAR_M


def _placed_within(run: RunRecord, most: int) -> Share | None:
    """Return the stones whose first relocation took so many attempts at most."""
    found = stones(run)
    if not found:
        return None
    first: dict[int, PickReport] = {}
    for pick in run.report.picks:
        first.setdefault(pick.object, pick)
    soon = {number for number, pick in first.items() if pick.placed and len(pick.attempts) <= most}
    hits = sum(_is_near(one) and one.held_object in soon for one in found)
    return Share(hits, len(found))
