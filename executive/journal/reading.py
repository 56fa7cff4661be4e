"""Reads a journal back: all its parts, each line checked against the one before it."""

import gzip
import zlib
from collections.abc import Iterator
from pathlib import Path

from executive.errors import DataError
from executive.journal.entry import FIRST_CHECKSUM, Entry, entry_of
from executive.journal.segment_file import closed_segments


class JournalFile:
    """A journal on the disk.

    A last line without its end is what a crash or a full disk leaves: it is left out, and told.
    Any other damage is refused with its place.

    Attributes:
        path: Its newest part, `journal.jsonl`.
        cut_off: Number of bytes of a last line that was cut off; known after reading.
        whole_bytes: Number of bytes of `path` before that line; known after reading.
        checksum: Checksum of the last entry; known after reading.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.cut_off = self.whole_bytes = 0
        self.checksum = FIRST_CHECKSUM

    def entries(self) -> Iterator[Entry]:
        """Read one entry after the other.

        Raises:
            DataError: At the first line that is damaged, missing or out of order; it names the
                line.
            FileNotFoundError: If there is no such file.
        """
        sequence = 0
        parts = [part for _, part in closed_segments(self.path)]
        for part in (*parts, self.path):
            for number, line in enumerate(self._lines(part), 1):
                try:
                    entry, self.checksum = entry_of(line, self.checksum, sequence)
                except DataError as error:
                    raise DataError(f"{part}:{number}: {error}") from error
                sequence += 1
                yield entry

    def _lines(self, part: Path) -> Iterator[str]:
        number = 0
        try:
            with gzip.open(part, "rb") if part.suffix == ".gz" else part.open("rb") as file:
                for line in file:
                    number += 1
                    if not line.endswith(b"\n") and part == self.path:
                        self.cut_off = len(line)
                        return
                    if part == self.path:
                        self.whole_bytes += len(line)
                    yield line.decode("utf-8")
        except (UnicodeDecodeError, EOFError, gzip.BadGzipFile, zlib.error) as error:
            raise DataError(f"{part}:{max(number, 1)}: not a line of a journal: {error}") from error


def read_journal(path: Path) -> Iterator[Entry]:
    """Read a journal back, checking each line; see `JournalFile`.

    Raises:
        DataError: At the first line that is damaged, missing or out of order; it names the line.
    """
    yield from JournalFile(path).entries()
