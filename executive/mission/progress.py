"""Progress for a person: a live tree on a terminal, plain lines elsewhere;
all on standard error.
"""

import sys
from collections.abc import Callable
from typing import Any

from rich.console import Console
from rich.live import Live
from rich.text import Text

from executive.clock import wall_s
from executive.mission.mission import Mission
from executive.tree.build import node_states

_REFRESH_S = 0.25  # on the wall
_MARKS = {
    "SUCCESS": ("✓", "green"),
    "FAILURE": ("✗", "red"),
    "RUNNING": ("▶", "bold cyan"),
    "INVALID": ("·", "dim"),
}
# Entries worth a line, and what the line says.
_TOLD: dict[str, Callable[[Any], str]] = {
    "localised": lambda p: f"localised ({p['status']})",
    "surveyed": lambda p: f"drone map of {p['points']} points",
    "scanned": lambda p: f"map of {p['points']} points",
    "registration": lambda p: (
        f"drone map {'registered' if p['accepted'] else 'refused'}: {p['reason']}"
    ),
    "segmented": lambda p: f"{len(p['stones'])} stones found",
    "slots": lambda p: f"{len(p['slots'])} free places",
    "attempt": lambda p: f"stone {p['stone']}: going for it",
    "grasped": lambda p: f"stone {p['stone']}: grasped at {p['jaw_rad']:.2f} rad",
    "closed_on_nothing": lambda p: f"stone {p['stone']}: {p['reason']}",
    "verdict": lambda p: f"{p['trouble']}: {p['detail']}",
    "released": lambda p: f"stone {p['stone']}: set down on slot {p['slot']}",
    "let_go": lambda p: f"stone {p['stone']}: let go",
    "realigned": lambda p: (
        f"stone {p['stone']}: {'realigned' if p['accepted'] else 'not realigned: ' + p['reason']}"
    ),
    "set_aside": lambda p: f"stone {p['stone']}: set aside, {p['reason']}",
    "phase": lambda p: f"{p['to']}" + (f": {p['reason']}" if p["reason"] else ""),
}


class PlainProgress:
    """One line an event."""

    def __init__(self) -> None:
        self._told = 0

    def __call__(self, mission: Mission) -> None:
        entries = mission.journal.entries
        for entry in entries[self._told :]:
            if entry.kind in _TOLD:
                print(
                    f"{entry.time_s:8.2f} s  {_TOLD[entry.kind](entry.payload)}",
                    file=sys.stderr,
                    flush=True,
                )
        self._told = len(entries)

    def __enter__(self) -> "PlainProgress":
        return self

    def __exit__(self, *_: object) -> None:
        return None


class LiveProgress:
    """The tree with live states, redrawn a few times a second."""

    def __init__(self) -> None:
        self._console = Console(stderr=True)
        self._live = Live(console=self._console, auto_refresh=False)
        self._started_s = self._drawn_s = wall_s()
        self._lines = 0

    def __call__(self, mission: Mission) -> None:
        now_s = wall_s()
        if now_s - self._drawn_s >= _REFRESH_S:
            self._drawn_s = now_s
            self._live.update(self._picture(mission, now_s), refresh=True)

    def __enter__(self) -> "LiveProgress":
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def _picture(self, mission: Mission, now_s: float) -> Text:
        elapsed_s = mission.clock.now_s()
        ratio = elapsed_s / max(now_s - self._started_s, 1e-3)
        placed = sum(entry.kind == "released" for entry in mission.journal.entries)
        stones: list[int] = next(
            (
                e.payload["stones"]
                for e in reversed(mission.journal.entries)
                if e.kind == "segmented"
            ),
            [],
        )
        head = f"{mission.phase}  {elapsed_s:7.1f} s  {ratio:.1f}× real time"
        text = Text(
            head + (f"  stone {placed} of {len(stones)}" if stones else "") + "\n", style="bold"
        )
        room = max(5, self._console.height - 3)
        rows = [row for row in node_states(mission.root) if row.is_worth_showing]
        for row in rows[:room]:
            mark, style = _MARKS[row.status]
            feedback = f"  {row.feedback}" if row.feedback else ""
            text.append(f"{'  ' * row.depth}{mark} {row.name}", style=style)
            text.append(f"{feedback}\n", style="dim")
        return text


def progress(*, quiet: bool) -> Any:
    """Return the progress that suits standard error: live, plain, or none."""
    if quiet:
        return Silence()
    return LiveProgress() if sys.stderr.isatty() else PlainProgress()


class Silence:
    """No progress."""

    def __call__(self, mission: Mission) -> None:
        return None

    def __enter__(self) -> "Silence":
        return self

    def __exit__(self, *_: object) -> None:
        return None
