"""The files of a journal: one that is written, and closed ones that a thread compresses.

`journal.jsonl` is the newest part. When it has reached its size it becomes `journal.0001.jsonl` and
then `journal.0001.jsonl.gz`, which takes about a fifteenth of the room.
"""

import gzip
import os
import re
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

SEGMENT_BYTES = 8 * 2**20
_PART_BYTES = 2**17  # compressed in a few milliseconds
_SYNC_PERIOD_S = 0.5  # what is lost at most when the power fails, but for irreversible steps


class SegmentFile:
    """Appends lines; a thread puts them on the disk and compresses what is closed.

    A line that cannot be written whole, such as on a full disk, is taken back: the file ends with
    the line before it.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o644)
        self._size = os.fstat(self._file).st_size
        self._number = max((number for number, _ in closed_segments(path)), default=0)
        self._written = self._secured = 0  # lines
        self._full: list[int] = []  # files that were closed to lines, and are not on the disk yet
        self._error: OSError | None = None
        self._is_closing = False
        self._changed = threading.Condition()
        self._wanted = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="journal", daemon=True)
        self._thread.start()

    def write(self, line: str) -> None:
        """Hand a line to the operating system.

        Raises:
            OSError: If it cannot be written, such as on a full disk.
        """
        data = line.encode()
        if self._size + len(data) > SEGMENT_BYTES and self._size:
            self._rotate()
        try:
            written = os.write(self._file, data)
            if written != len(data):  # a full disk takes what it can
                written += os.write(self._file, data[written:])
        except OSError:
            os.ftruncate(self._file, self._size)
            raise
        self._size += len(data)
        self._written += 1

    def secure(self) -> None:
        """Wait until what was written is on the disk.

        Raises:
            OSError: If the disk does not take it.
        """
        wanted = self._written
        self._wanted.set()
        with self._changed:
            self._changed.wait_for(lambda: self._secured >= wanted or self._error is not None)
        if self._error is not None:
            raise self._error

    def close(self) -> None:
        """Put everything on the disk and end the thread."""
        self._is_closing = True
        self._wanted.set()
        self._thread.join()
        os.close(self._file)

    def _rotate(self) -> None:
        """Begin a new file; the thread puts the old one on the disk: that can take seconds."""
        self._number += 1
        with self._changed:  # not while the thread uses the file
            self._path.rename(self._path.with_name(f"{self._path.stem}.{self._number:04d}.jsonl"))
            self._full.append(self._file)
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND | os.O_CLOEXEC
            self._file = os.open(self._path, flags, 0o644)
        self._size = 0

    def _serve(self) -> None:
        while not self._is_closing:
            self._wanted.wait(_SYNC_PERIOD_S)
            self._wanted.set()
            self._attend()
            self._compress()
        self._sync()

    def _attend(self) -> None:
        """Put on the disk what somebody waits for."""
        if self._wanted.is_set():
            self._wanted.clear()
            self._sync()

    def _sync(self) -> None:
        written = self._written
        if written == self._secured:
            return
        with self._changed:
            files = [*self._full, os.dup(self._file)]  # the tick may rotate meanwhile
            self._full.clear()
        for file in files:
            try:
                os.fdatasync(file)
            except OSError as error:
                self._error = error
            finally:
                os.close(file)
        with self._changed:
            self._secured = written
            self._changed.notify_all()

    def _compress(self) -> None:
        for _, segment in closed_segments(self._path):
            if segment.suffix == ".jsonl":
                try:
                    compress(segment, self._attend)
                except OSError as error:  # the segment stays as it is, and is tried again
                    self._error = self._error or error


def compress(segment: Path, between: Callable[[], None] = lambda: None) -> Path:
    """Replace a file by its compressed form, whole or not at all; equal files give equal bytes.

    Args:
        segment: The file.
        between: Called again and again while it is compressed, which takes tenths of a second.
    """
    whole = segment.with_name(segment.name + ".gz")
    partial = whole.with_suffix(".partial")
    with segment.open("rb") as source, partial.open("wb") as target:
        with gzip.GzipFile("", "wb", 6, target, mtime=0) as packed:
            while part := source.read(_PART_BYTES):
                packed.write(part)
                between()
        target.flush()
        os.fsync(target.fileno())
    partial.replace(whole)
    segment.unlink()
    return whole


def closed_segments(path: Path) -> Iterator[tuple[int, Path]]:
    """Yield number and path of the closed parts of a journal, oldest first."""
    form = re.compile(re.escape(path.stem) + r"\.(\d{4,})\.jsonl(\.gz)?")
    found: dict[int, Path] = {}
    for one in sorted(path.parent.glob(f"{path.stem}.*.jsonl*"), reverse=True):
        if match := form.fullmatch(one.name):  # `.jsonl` goes over a `.gz` beside it: it is whole
            found[int(match[1])] = one
    yield from sorted(found.items())
