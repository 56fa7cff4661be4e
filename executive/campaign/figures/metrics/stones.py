"""Metrics of the stones at their slots, by the simulator's truth."""

from collections.abc import Mapping, Sequence
from typing import Any

from executive.interfaces.metric import Metric, RunRecord, Share, Values
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
        stones = _stones(run)
        return Share(sum(_is_near(stone) for stone in stones), len(stones)) if stones else None


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
        stones = _stones(run)
        if not stones:
            return None
        first: dict[int, Mapping[str, Any]] = {}
        for pick in run.report["picks"]:
            first.setdefault(pick["object"], pick)
        at_once = {
            stone for stone, pick in first.items() if pick["placed"] and len(pick["attempts"]) == 1
        }
        hits = sum(_is_near(stone) and stone["held_object"] in at_once for stone in stones)
        return Share(hits, len(stones))


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
        errors = [stone["slot_error_m"] for stone in _stones(run)]
        return Values(tuple(error for error in errors if error is not None)) if errors else None


def _stones(run: RunRecord) -> Sequence[Mapping[str, Any]]:
    found: Sequence[Mapping[str, Any]] = run.report.get("truth", {}).get("stones", ())
    return found


def _is_near(stone: Mapping[str, Any]) -> bool:
    error = stone["slot_error_m"]
    return error is not None and error <= NEAR_M
