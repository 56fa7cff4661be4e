"""Writes entries as they happen, and keeps the newest ones in memory."""

from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path

from executive.events.event import Event
from executive.journal.entry import FIRST_CHECKSUM, Entry, line_of, rounded
from executive.journal.segment_file import SegmentFile

_KEPT = 5000  # entries in memory; whoever needs older ones follows the journal, or reads the file

Listener = Callable[[Entry], None]


class Journal:
    """The record of a run, while it is written.

    Each line is handed to the operating system before `append` returns, so that it outlives this
    process. `secure` waits until all lines are on the disk, so that they outlive a loss of power.

    Attributes:
        failure: Why lines are no longer written, such as a full disk; None while they are. What is
            in the file then is whole up to its last line, and listeners are told all the same.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._file = SegmentFile(path) if path else None
        self._checksum = FIRST_CHECKSUM
        self._next = 0
        self._newest: deque[Entry] = deque(maxlen=_KEPT)
        self._listeners: list[Listener] = []
        self.failure: OSError | None = None

    @property
    def newest(self) -> Sequence[Entry]:
        """Return the newest entries, oldest first; not all of a long run."""
        return self._newest

    @property
    def last(self) -> Entry | None:
        """Return the newest entry."""
        return self._newest[-1] if self._newest else None

    @property
    def length(self) -> int:
        """Return the number of entries so far: the number of the next one."""
        return self._next

    def since(self, sequence: int) -> list[Entry]:
        """Return the entries from a number on, as far as they are in memory."""
        count = min(self._next - sequence, len(self._newest))
        return [self._newest[i] for i in range(len(self._newest) - count, len(self._newest))]

    def follow(self, listener: Listener) -> None:
        """Call a function with each entry from now on, once it is written."""
        self._listeners.append(listener)

    def go_on_after(self, entry: Entry, checksum: str) -> None:
        """Continue the file of a run that was cut off, after its last entry."""
        self._newest.append(entry)
        self._next, self._checksum = entry.sequence + 1, checksum

    def append(self, tick: int, time_s: float, node: str, event: Event) -> None:
        """Add one entry; numpy values become plain numbers and lists in the file."""
        entry = Entry(self._next, tick, rounded(time_s), node, event)
        if self._file is not None and self.failure is None:
            line, self._checksum = line_of(entry, self._checksum)
            try:
                self._file.write(f"{line}\n")
            except OSError as error:
                self.failure = error
        self._next += 1
        self._newest.append(entry)
        for listener in self._listeners:
            listener(entry)

    def secure(self) -> None:
        """Wait until all lines are on the disk: about 3 ms, at worst tens of milliseconds."""
        if self._file is None or self.failure is not None:
            return
        try:
            self._file.secure()
        except OSError as error:
            self.failure = error

    def close(self) -> None:
        """Close the file; the newest entries stay readable."""
        if self._file:
            self._file.close()
            self._file = None
