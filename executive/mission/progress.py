"""Progress on standard error: a live tree on a terminal, plain lines elsewhere."""

import os
import sys
from typing import Any

from rich.console import Console
from rich.live import Live
from rich.text import Text

from executive.clock import wall_s
from executive.mission.event_lines import line_of
from executive.mission.mission import Mission
from executive.mission.phase import Phase
from executive.tree.build import node_states

_REFRESH_S = 0.25  # on the wall
_MARKS = {
    "SUCCESS": ("✓", "green"),
    "FAILURE": ("✗", "red"),
    "RUNNING": ("▶", "bold cyan"),
    "SKIPPED": ("–", "dim"),
    "INVALID": ("·", "dim"),
}


class PlainProgress:
    """One line an event."""

    def __init__(self) -> None:
        self._told = 0

    def __call__(self, mission: Mission) -> None:
        entries = mission.journal.since(self._told)
        for entry in entries:
            if line := line_of(entry.event):
                print(f"{entry.time_s:8.2f} s  {line}", file=sys.stderr, flush=True)
        self._told = entries[-1].sequence + 1 if entries else self._told

    def __enter__(self) -> "PlainProgress":
        return self

    def __exit__(self, *_: object) -> None:
        return None


class LiveProgress:
    """The tree with live states, redrawn a few times a second."""

    def __init__(self) -> None:
        # Without markup: rich would take the `[y/N]` of a question for a style, and drop it.
        self._console = Console(stderr=True, markup=False, highlight=False, emoji=False)
        self._live = Live(console=self._console, auto_refresh=False)
        self._started_s = self._drawn_s = wall_s()
        self._is_asking = False

    def __call__(self, mission: Mission) -> None:
        now_s = wall_s()
        if mission.phase is Phase.AWAITING_OPERATOR and self._is_asking:
            return  # drawing would run over what the operator types
        self._is_asking = mission.phase is Phase.AWAITING_OPERATOR
        if self._is_asking or now_s - self._drawn_s >= _REFRESH_S:
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
        placed, stones = mission.account.placed, mission.account.stones_found
        head = f"{mission.phase}  {elapsed_s:7.1f} s  {ratio:.1f}× real time"
        text = Text(head + (f"  stone {placed} of {stones}" if stones else "") + "\n", style="bold")
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
    return Tolerant(LiveProgress() if sys.stderr.isatty() else PlainProgress())


class Tolerant:
    """Progress that falls silent when nobody reads it any more: the mission goes on."""

    def __init__(self, shown: Any) -> None:
        self._shown = shown

    def __call__(self, mission: Mission) -> None:
        try:
            self._shown(mission)
        except OSError:  # a closed pipe, or a terminal that is gone
            self._shown = Silence()
            drop_errors()

    def __enter__(self) -> "Tolerant":
        self._shown.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        try:
            self._shown.__exit__(*error)
        except OSError:
            drop_errors()


def drop_errors() -> None:
    """Send what is written to standard error nowhere from now on."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.__stderr__.fileno() if sys.__stderr__ is not None else 2)
    os.close(nowhere)


class Silence:
    """No progress."""

    def __call__(self, mission: Mission) -> None:
        return None

    def __enter__(self) -> "Silence":
        return self

    def __exit__(self, *_: object) -> None:
        return None
