"""What became of each stone, read from the journal: attempts, where it was put, where it was set aside."""

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
    """All attempts at one stone, and where it stands now."""

    stone: int
    tries: list[Try] = field(default_factory=list)
    released: Mapping[str, Any] | None = None
    estimated_pose: Any = None
    set_aside: str = ""

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
            "placed": self.released is not None and not self.set_aside,
            "slot": released.get("slot"),
            "planned_pose": released.get("planned_pose"),
            "estimated_pose": self.estimated_pose or released.get("estimated_pose"),
            "set_aside": self.set_aside or None,
        }


def picks_from(entries: Iterable[Entry]) -> list[Pick]:
    """Read all picks, in the order in which the stones were first tried."""
    picks: dict[int, Pick] = {}
    current: Try | None = None
    last_s = 0.0
    for entry in entries:
        payload = entry.payload
        if entry.kind == "attempt":
            _cut_off(current, entry.time_s)
            stone = payload["stone"]
            current = Try(stone, entry.time_s, payload["grasp"], tuple(payload["centroid_map"]), entry.time_s)
            pick = picks.setdefault(stone, Pick(stone))
            pick.tries.append(current)
            pick.released, pick.estimated_pose = None, None
        elif entry.kind in ("verdict", *_ENDINGS) and current is not None:
            _end(current, entry)
        if entry.kind == "released":
            picks.setdefault(payload["stone"], Pick(payload["stone"])).released = payload
        elif entry.kind == "realigned" and payload["stone"] in picks:
            picks[payload["stone"]].estimated_pose = payload["estimated_pose"]
        elif entry.kind == "set_aside":
            picks.setdefault(payload["stone"], Pick(payload["stone"])).set_aside = payload["reason"]
        last_s = entry.time_s
    _cut_off(current, last_s)
    return list(picks.values())


def _cut_off(current: Try | None, now_s: float) -> None:
    """End an attempt that nothing has ended: by the next one, or by the end of the run."""
    if current is not None and current.outcome == "unfinished":
        current.ended_s = now_s


def _end(current: Try, entry: Entry) -> None:
    current.ended_s = entry.time_s
    if current.outcome in ("unfinished", "failed"):  # the first cause stands; what follows from it does not replace it
        current.outcome = _ENDINGS.get(entry.kind) or entry.payload["trouble"]
        current.reason = entry.payload.get("reason") or entry.payload.get("detail") or ""


def attempts_from(picks: Iterable[Pick]) -> list[Attempt]:
    """Return all attempts in order of time, for the oracle."""
    tries = sorted((t for pick in picks for t in pick.tries), key=lambda t: t.started_s)
    return [Attempt(t.stone, t.started_s, t.ended_s, t.outcome, t.centroid_map) for t in tries]
