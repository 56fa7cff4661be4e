"""The append-only record of what a mission intended, did and verified.

One JSON object a line: sequence, tick, time, kind, node path, payload, and a checksum over the line
and its predecessor's checksum, so that a lost, changed or swapped line shows. Nothing in it depends
on the wall clock.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from executive.errors import DataError

_DIGITS = 16  # of the checksum, in hexadecimal


@dataclass(frozen=True, slots=True)
class Entry:
    """One line of the journal."""

    sequence: int
    tick: int
    time_s: float
    kind: str
    node: str
    payload: Mapping[str, Any]


class Journal:
    """Writes entries as they happen; each line is on its way to the disk before the next tick."""

    def __init__(self, path: Path | None = None) -> None:
        self._file: TextIO | None = path.open("w", encoding="utf-8", newline="\n") if path else None
        self._checksum = "0" * _DIGITS
        self.entries: list[Entry] = []

    def append(
        self, tick: int, time_s: float, kind: str, node: str, payload: Mapping[str, Any]
    ) -> None:
        """Add one entry; numpy values become plain numbers and lists."""
        entry = Entry(len(self.entries), tick, round(time_s, 6), kind, node, plain(payload))
        self.entries.append(entry)
        body = _body(entry)
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
            fields = json.loads(line)
            stated = fields.pop("checksum")
            entry = Entry(
                *(fields[k] for k in ("sequence", "tick", "time_s", "kind", "node", "payload"))
            )
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise DataError(f"{path}:{number}: not a line of a journal: {error}") from error
        checksum = _chain(checksum, _body(entry))
        if stated != checksum or entry.sequence != number - 1:
            raise DataError(f"{path}:{number}: the line or one before it was changed or lost")
        yield entry


def plain(value: Any) -> Any:
    """Turn a value into what JSON holds: numbers, strings, lists, mappings."""
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if value is None or isinstance(value, bool | int | float | str):
        return value
    return str(value)


def _body(entry: Entry) -> str:
    fields = {name: getattr(entry, name) for name in Entry.__slots__}
    return json.dumps(fields, ensure_ascii=False, separators=(",", ":"), allow_nan=True)


def _chain(previous: str, body: str) -> str:
    return hashlib.sha256((previous + body).encode()).hexdigest()[:_DIGITS]
