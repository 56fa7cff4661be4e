"""Runs that have ended: their folders and reports."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_TIPPED = "tipped over"  # in the reason of a run that ended for it


@dataclass(frozen=True, slots=True)
class Ended:
    """A run that has ended: its folder, and its report as JSON holds it."""

    folder: Path
    report: dict[str, Any]

    @property
    def truth(self) -> dict[str, Any]:
        """What the simulator knows; empty of a run that it does not know."""
        return self.report.get("truth") or {}

    @property
    def limits(self) -> list[dict[str, Any]]:
        """How near it came to its limits; empty where nothing observed them."""
        return self.truth.get("limits") or []

    @property
    def is_observed(self) -> bool:
        """Whether limits and collisions are known."""
        return bool(self.limits) and self.truth.get("collisions") is not None

    @property
    def has_tipped(self) -> bool:
        """Whether it ended because the machine had tipped over."""
        return _TIPPED in json.dumps([self.report.get("reason"), self.report.get("fault")])

    @property
    def cycles(self) -> int:
        """Number of attempts at stones."""
        return sum(len(pick["attempts"]) for pick in self.report.get("picks") or ())


def found_in(folders: Sequence[Path]) -> list[Ended]:
    """Return the runs in folders, each once, in the order of their paths."""
    paths = sorted({path.resolve() for one in folders for path in one.rglob("report.json")})
    return [Ended(path.parent, json.loads(path.read_text(encoding="utf-8"))) for path in paths]
