"""The newest of values that are written often, in a file of two places that take turns.

Replacing a file by a new one makes the file system write the new one out, which takes milliseconds,
and seconds on a busy disk. Here a value is written over the one before the last, so that a process
that is killed in the middle leaves the last one whole.
"""

import os
import struct
from pathlib import Path
from zlib import crc32

_HEAD = struct.Struct("<QQI")  # number of the value from 1, its length [bytes], its checksum
_PLACES = ("0", "1")


class NewestFile:
    """Writes values as bytes; `newest_in` reads the newest whole one."""

    def __init__(self, path: Path) -> None:
        """Go on after the values that are there.

        Args:
            path: The name of both places, to which their numbers are added.
        """
        self._places = [path.with_name(f"{path.name}.{place}") for place in _PLACES]
        self._files: list[int] = []
        self._number = max((number for number, _ in _whole(path)), default=0)

    def write(self, value: bytes) -> None:
        """Write a value.

        Raises:
            OSError: If it cannot be written, such as on a full disk; the last one is kept.
        """
        if not self._files:
            flags = os.O_WRONLY | os.O_CREAT | os.O_CLOEXEC
            self._files = [os.open(place, flags, 0o644) for place in self._places]
        number = self._number + 1
        data = _HEAD.pack(number, len(value), crc32(value)) + value
        file, done = self._files[number % 2], 0
        while done < len(data):
            done += os.pwrite(file, data[done:], done)
        self._number = number

    def close(self) -> None:
        """Close the files."""
        for file in self._files:
            os.close(file)
        self._files.clear()


def newest_in(path: Path) -> bytes | None:
    """Return the newest whole value of a `NewestFile`; None if there is none."""
    return max(_whole(path), default=(0, None))[1]


def _whole(path: Path) -> list[tuple[int, bytes]]:
    """Return number and value of each place that is whole."""
    found = []
    for place in _PLACES:
        try:
            data = path.with_name(f"{path.name}.{place}").read_bytes()
        except OSError:
            continue
        if len(data) < _HEAD.size:
            continue
        number, length, checksum = _HEAD.unpack_from(data)
        value = data[_HEAD.size : _HEAD.size + length]
        if len(value) == length and crc32(value) == checksum:
            found.append((number, value))
    return found
