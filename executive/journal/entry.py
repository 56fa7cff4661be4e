"""One line of a journal: sequence, tick, time, kind, node path, payload, and a checksum.

The checksum is over the line and its predecessor's checksum, so that a lost, changed or swapped
line shows. Nothing in a line depends on the wall clock.
"""

import hashlib
import json
from dataclasses import dataclass

from executive.errors import DataError
from executive.events.event import Event, UnknownEvent, event_from

_DIGITS = 16  # of the checksum, in hexadecimal
FIRST_CHECKSUM = "0" * _DIGITS
_TIME_DIGITS = 9  # nanoseconds: what a replay compares with a limit must not be rounded across it
_MOST_S = 1e12  # of a time: 30,000 years
_FIELDS = ("sequence", "tick", "time_s", "kind", "node", "payload")
_ENCODER = json.JSONEncoder(ensure_ascii=False, separators=(",", ":"))


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


def rounded(time_s: float) -> float:
    """Return a time as the journal holds it [s]."""
    return round(time_s, _TIME_DIGITS)


def line_of(entry: Entry, before: str) -> tuple[str, str]:
    """Return the line of an entry without its end, and its checksum.

    Args:
        entry: The entry.
        before: Checksum of the entry before it.
    """
    e = entry
    body = _body((e.sequence, e.tick, e.time_s, e.kind, e.node, e.event.payload()))
    checksum = _chain(before, body)
    return f'{body[:-1]},"checksum":"{checksum}"}}', checksum


def entry_of(line: str, before: str, sequence: int) -> tuple[Entry, str]:
    """Return the entry of a line, and its checksum.

    Args:
        line: The line.
        before: Checksum of the line before it.
        sequence: Number that the line has to have.

    Raises:
        DataError: If it is no line of a journal, or does not follow the line before it.
    """
    try:
        found = json.loads(line)
        stated = found.pop("checksum")
        number, tick, time_s, kind, node, payload = values = [found[name] for name in _FIELDS]
        _check_kinds(tick, time_s, node)
        event = event_from(kind, payload)
    except DataError:
        raise
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise DataError(f"not a line of a journal: {error}") from error
    if stated != _chain(before, _body(tuple(values))) or number != sequence:
        raise DataError("the line or one before it was changed or lost")
    return Entry(number, tick, time_s, node, event), stated


def _check_kinds(tick: object, time_s: object, node: object) -> None:
    is_number = isinstance(time_s, int | float) and abs(time_s) < _MOST_S  # false for NaN
    if not (is_number and isinstance(tick, int) and isinstance(node, str)):
        raise DataError("not a line of a journal: tick, time or node is of another kind")


def _body(values: tuple[object, ...]) -> str:
    return _ENCODER.encode(dict(zip(_FIELDS, values, strict=True)))


def _chain(previous: str, body: str) -> str:
    return hashlib.sha256((previous + body).encode()).hexdigest()[:_DIGITS]
