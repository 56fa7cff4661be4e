"""A run's journal for people: its lines, and the tree as it was at a time."""

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from executive.errors import ConfigError
from executive.events.node import NodeEnded, NodeResult, NodeStarted
from executive.journal import Entry, JournalFile
from executive.mission.event_lines import line_of
from executive.mission.run_folder import RunFolder

_NODE = 44  # characters of a path: two or three nodes


@contextmanager
def reading(run_dir: Path) -> Iterator[Iterator[Entry]]:
    """Read a run's journal; a last line that was cut off is told.

    Raises:
        ConfigError: If the folder holds no journal.
        DataError: At a damaged line, by its place.
    """
    path = RunFolder(run_dir).journal
    if not path.is_file():
        raise ConfigError(f"{run_dir} holds no run: it has no journal.jsonl")
    file = JournalFile(path)
    yield file.entries()
    if file.cut_off:
        told = f"warning: {path}: the last line is cut off after {file.cut_off} bytes and left out"
        print(told, file=sys.stderr)


def plain_entry(entry: Entry) -> dict[str, Any]:
    """Return an entry as JSON holds it."""
    e = entry
    return {
        "sequence": e.sequence,
        "tick": e.tick,
        "time_s": e.time_s,
        "kind": e.kind,
        "node": e.node,
        "payload": e.event.payload(),
    }


def line_for_people(entry: Entry, width: int | None = None) -> str:
    """Return an entry as one line: its time, kind, the end of its node's path, and what it says.

    Args:
        entry: The entry.
        width: Characters after which the line is cut; None leaves it whole.
    """
    said = line_of(entry.event) or json.dumps(entry.event.payload(), ensure_ascii=False)
    text = f"{entry.time_s:9.2f} s  {entry.kind:<20} {_end_of(entry.node):<{_NODE}}  {said}"
    return text if width is None or len(text) <= width else f"{text[: width - 1]}…"


def _end_of(path: str) -> str:
    """Return a node's path, or its last parts where it is long."""
    if len(path) <= _NODE:
        return path
    parts = path.split("/")
    while len(parts) > 1 and len("/".join(parts)) > _NODE - 2:
        parts.pop(0)
    return f"…/{'/'.join(parts)}"


@dataclass(frozen=True, slots=True)
class Moment:
    """The tree after one entry.

    Attributes:
        entry: The entry; None before the first.
        states: `running` or how each node ended last, and why, by path.
    """

    entry: Entry | None
    states: dict[str, tuple[str, str]]

    def lines(self, width: int | None = None) -> Iterator[str]:
        """Yield the entry, cut to a width, then the nodes that run, outermost first."""
        yield line_for_people(self.entry, width) if self.entry else "before the first event"
        for node in sorted(self.states):
            state, reason = self.states[node]
            if state == "running":
                depth = node.count("/")
                yield f"{'  ' * depth}▶ {node.rpartition('/')[2]}"
            elif reason and self.entry is not None and self.entry.node == node:
                yield f"  {state}: {reason}"


class Moments:
    """The moments of a run, from one event to the next and back."""

    def __init__(self, entries: Iterator[Entry]) -> None:
        self._entries = tuple(entries)
        self.at = 0  # number of entries that have happened

    def __len__(self) -> int:
        return len(self._entries)

    def step(self, count: int) -> None:
        """Go on by some events, or back; not beyond the ends."""
        self.at = min(max(self.at + count, 0), len(self._entries))

    def go_to(self, time_s: float) -> None:
        """Go to the last event at a time or before it [s]."""
        self.at = sum(entry.time_s <= time_s for entry in self._entries)

    def moment(self) -> Moment:
        """Return the tree as it is there."""
        states: dict[str, tuple[str, str]] = {}
        for entry in self._entries[: self.at]:
            match entry.event:
                case NodeStarted():
                    states[entry.node] = "running", ""
                case NodeEnded(status=NodeResult() as status, reason=reason):
                    states[entry.node] = status.value, reason
        return Moment(self._entries[self.at - 1] if self.at else None, states)
