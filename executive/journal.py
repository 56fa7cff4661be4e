"""The append-only record of what a mission intended, did and verified.

One JSON object a line: sequence, tick, time, kind, node path, payload, and a checksum over the line
and its predecessor's checksum, so that a lost, changed or swapped line shows. Nothing in it depends
on the wall clock.
"""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from executive.errors import DataError
from executive.events import mission, node, site, stone
from executive.events.event import Event, UnknownEvent, event_from

# Reading a journal needs the classes of its events; importing their modules registers them.
EVENT_MODULES = (mission, node, site, stone)
_DIGITS = 16  # of the checksum, in hexadecimal
_FIELDS = ("sequence", "tick", "time_s", "kind", "node", "payload")


@dataclass(frozen=True, slots=True)
class Entry:
    """One line of the journal.

    Attributes:
        sequence: Number of the line, from 0.
        tick: Number of the tick.
        time_s: The mission's time [s].
        node: Path of the node that recorded the event; empty for the mission itself.
        event: What happened.
    """

    sequence: int
    tick: int
    time_s: float
    node: str
    event: Event

    @property
    def kind(self) -> str:
        """Return the event's name in the journal."""
        return self.event.name if isinstance(self.event, UnknownEvent) else self.event.kind


class Journal:
    """Writes entries as they happen; each line is flushed before the next tick."""

    def __init__(self, path: Path | None = None) -> None:
        self._file: TextIO | None = path.open("w", encoding="utf-8", newline="\n") if path else None
        self._checksum = "0" * _DIGITS
        self.entries: list[Entry] = []

    def append(self, tick: int, time_s: float, node: str, event: Event) -> None:
        """Add one entry; numpy values become plain numbers and lists in the file."""
        entry = Entry(len(self.entries), tick, round(time_s, 6), node, event)
        self.entries.append(entry)
        values = (entry.sequence, tick, entry.time_s, entry.kind, node, event.payload())
        body = _body(values)
        self._checksum = _chain(self._checksum, body)
        if self._file:
            self._file.write(f'{body[:-1]},"checksum":"{self._checksum}"}}\n')
            self._file.flush()

    def close(self) -> None:
        """Close the file; entries stay readable."""
        if self._file:
            self._file.close()
            self._file = None


def read_journal(path: Path) -> Iterator[Entry]:
    """Read a journal back, checking each line.

    Raises:
        DataError: At the first line that is damaged, missing or out of order; it names the line.
    """
    checksum = "0" * _DIGITS
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        try:
            found = json.loads(line)
            stated = found.pop("checksum")
            sequence, tick, time_s, kind, node_path, payload = (found[name] for name in _FIELDS)
            event = event_from(kind, payload)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise DataError(f"{path}:{number}: not a line of a journal: {error}") from error
        except DataError as error:
            raise DataError(f"{path}:{number}: {error}") from error
        checksum = _chain(checksum, _body((sequence, tick, time_s, kind, node_path, payload)))
        if stated != checksum or sequence != number - 1:
            raise DataError(f"{path}:{number}: the line or one before it was changed or lost")
        yield Entry(sequence, tick, time_s, node_path, event)


def _body(values: tuple[Any, ...]) -> str:
    fields = dict(zip(_FIELDS, values, strict=True))
    return json.dumps(fields, ensure_ascii=False, separators=(",", ":"), allow_nan=True)


def _chain(previous: str, body: str) -> str:
    return hashlib.sha256((previous + body).encode()).hexdigest()[:_DIGITS]
