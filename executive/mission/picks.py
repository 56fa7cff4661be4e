"""What became of each stone, read from the journal: attempts, where it was put, where it was set
aside.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from executive.interfaces.oracle import Attempt
from executive.journal import Entry

# Entries that end an attempt, and the outcome that they stand for; a verdict brings its own.
_ENDINGS = {"released": "placed", "closed_on_nothing": "empty", "attempt_failed": "failed"}


@dataclass(slots=True)
class Try:
    """One attempt at a stone, from the choice of its grasp to its end."""

    stone: int
    started_s: float
    grasp: Mapping[str, Any]
    centroid_map: tuple[float, float, float]
    ended_s: float = 0.0
    outcome: str = "unfinished"
    reason: str = ""


@dataclass(slots=True)
class Pick:
    """One relocation of one stone: all attempts at it, and how it ended."""

    stone: int
    tries: list[Try] = field(default_factory=list)
    released: Mapping[str, Any] | None = None
    estimated_pose: Any = None
    set_aside: str = ""

    @property
    def is_over(self) -> bool:
        """Whether the stone was set down on its slot, or given up."""
        return self.released is not None or bool(self.set_aside)

    def as_report(self) -> dict[str, Any]:
        """Return the entry of the report."""
        released = self.released or {}
        return {
            "object": self.stone,
            "attempts": [
                {
                    "grasp": t.grasp,
                    "outcome": t.outcome,
                    "reason": t.reason,
                    "started_s": t.started_s,
                    "ended_s": t.ended_s,
                }
                for t in self.tries
            ],
            "placed": self.released is not None,
            "slot": released.get("slot"),
            "planned_pose": released.get("planned_pose"),
            "estimated_pose": self.estimated_pose or released.get("estimated_pose"),
            "set_aside": self.set_aside or None,
        }


def picks_from(entries: Iterable[Entry]) -> list[Pick]:
    """Read all picks in the order in which they began; a stone that is moved again is
    picked again.
    """
    picks: list[Pick] = []
    newest: dict[int, Pick] = {}  # by stone
    current: Try | None = None
    last_s = 0.0

    def pick_of(stone: int) -> Pick:
        pick = newest.get(stone)
        if pick is None or pick.is_over:
            pick = newest[stone] = Pick(stone)
            picks.append(pick)
        return pick

    for entry in entries:
        payload = entry.payload
        if entry.kind == "attempt":
            _cut_off(current, entry.time_s)
            current = Try(
                payload["stone"],
                entry.time_s,
                payload["grasp"],
                tuple(payload["centroid_map"]),
                entry.time_s,
            )
            pick_of(payload["stone"]).tries.append(current)
        elif entry.kind in ("verdict", *_ENDINGS) and current is not None:
            _end(current, entry)
        if entry.kind in ("released", "set_aside"):
            _settle(pick_of(payload["stone"]), entry)
        elif entry.kind == "realigned" and payload["stone"] in newest:
            newest[payload["stone"]].estimated_pose = payload["estimated_pose"]
        elif entry.kind == "taken_up_again":
            _reopen(newest, payload["stones"])
        last_s = entry.time_s
    _cut_off(current, last_s)
    return picks


def _settle(pick: Pick, entry: Entry) -> None:
    if entry.kind == "released":
        pick.released = entry.payload
    else:
        pick.set_aside = entry.payload["reason"]


def _reopen(newest: Mapping[int, Pick], stones: Iterable[int]) -> None:
    """Let the picks of stones that were set aside go on: their tries before that count."""
    for stone in stones:
        newest[stone].set_aside = ""


def _cut_off(current: Try | None, now_s: float) -> None:
    """End an attempt that nothing has ended: by the next one, or by the end of the run."""
    if current is not None and current.outcome == "unfinished":
        current.ended_s = now_s


def _end(current: Try, entry: Entry) -> None:
    current.ended_s = entry.time_s
    if current.outcome in (
        "unfinished",
        "failed",
    ):  # the first cause stands; what follows from it does not replace it
        current.outcome = _ENDINGS.get(entry.kind) or entry.payload["trouble"]
        current.reason = entry.payload.get("reason") or entry.payload.get("detail") or ""


def attempts_from(picks: Iterable[Pick]) -> list[Attempt]:
    """Return all attempts in order of time, for the oracle."""
    tries = sorted((t for pick in picks for t in pick.tries), key=lambda t: t.started_s)
    return [Attempt(t.stone, t.started_s, t.ended_s, t.outcome, t.centroid_map) for t in tries]
