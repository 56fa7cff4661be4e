"""Sizes and places that the header of a LAS or LAZ file states, checked against the file's length.

Libraries allocate and loop by these numbers. Fields and their offsets are those of LAS 1.4 R15
(ASPRS), Table 3; the chunk table is described in Isenburg 2013, "LASzip: lossless compression of
lidar data".
"""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from executive.errors import DataError

_SHORTEST_HEADER, _HEADER_1_4 = 227, 375  # bytes
_RECORD_HEADER, _EXTENDED_HEADER = 54, 60  # bytes before the content of a variable length record
_MOST_CONTENT = 1 << 16  # bytes of a record that are read; a longer one holds no name
_PACKED_BITS = 0xC0  # of the point format: set in LAZ files
_LEAST_POINT = 20  # bytes of format 0, the shortest
_PROJECTION = b"LASF_Projection"
_LASZIP = b"laszip encoded"
_CHUNK_TABLE_AT_END = -1  # written by programs that could not go back


class _DamageError(Exception):
    """What the header states cannot be."""


def check_sizes(path: Path) -> None:
    """Refuse a file whose header states what its length cannot hold.

    Raises:
        DataError: If it does; the message names both numbers.
    """
    size = path.stat().st_size
    try:
        with path.open("rb") as file:
            _check(file, size)
    except _DamageError as damage:
        raise DataError(
            f"{path}: cut short or damaged: {damage}; the file has {size} bytes; copy or export "
            "it again"
        ) from None


def contents(path: Path) -> Iterator[tuple[bytes, int, bytes]]:
    """Yield the user's name, the number and the content of each record of a sound file."""
    with path.open("rb") as file:
        header = file.read(_HEADER_1_4)
        start, _, count = struct.unpack_from("<HII", header, 94)
        for form, size in (("<H16sHH", _RECORD_HEADER), ("<H16sHQ", _EXTENDED_HEADER)):
            for _ in range(count):
                file.seek(start)
                _, name, number, length = struct.unpack_from(form, file.read(size))
                yield name.rstrip(b"\0"), number, file.read(min(length, _MOST_CONTENT))
                start += size + length
            if header[25] < 4:
                return
            start, count = struct.unpack_from("<QI", header, 235)


def projection_records(path: Path) -> tuple[tuple[int, bytes], ...]:
    """Return the numbers and contents of a sound file's records of its coordinate system."""
    return tuple(
        (number, content) for user, number, content in contents(path) if user == _PROJECTION
    )


def _check(file: IO[bytes], size: int) -> None:
    header = file.read(_HEADER_1_4)
    if len(header) < _SHORTEST_HEADER or header[:4] != b"LASF":
        raise _DamageError("it has no LAS header")
    minor = header[25]
    header_bytes, points_at, records = struct.unpack_from("<HII", header, 94)
    if not _SHORTEST_HEADER <= header_bytes <= points_at <= size:
        raise _DamageError(f"its header has {header_bytes} bytes and points from byte {points_at}")
    packed = _check_records(file, header_bytes, records, points_at)
    if minor >= 4:
        if len(header) < _HEADER_1_4 or header_bytes < _HEADER_1_4:
            raise _DamageError(f"a LAS 1.4 header has {_HEADER_1_4} bytes, this one {header_bytes}")
        start, count = struct.unpack_from("<QI", header, 235)
        _check_extended(file, start, count, size)
    if header[104] & _PACKED_BITS:
        if not packed:
            raise _DamageError("its points are packed, and no record says how")
        _check_chunks(file, points_at, size)
    elif struct.unpack_from("<H", header, 105)[0] < _LEAST_POINT:
        raise _DamageError("its points are shorter than those of any LAS format")


def _check_records(file: IO[bytes], start: int, count: int, end: int) -> bool:
    """Check the variable length records; return whether one describes packed points."""
    if count * _RECORD_HEADER > end - start:
        raise _DamageError(f"its header promises {count} records before byte {end}")
    packed = False
    for length, name in _records(file, start, count):
        start += _RECORD_HEADER + length
        packed = packed or name == _LASZIP
        if start > end:
            raise _DamageError(f"a record ends at byte {start}, and points begin at {end}")
    return packed


def _records(file: IO[bytes], start: int, count: int) -> Iterator[tuple[int, bytes]]:
    """Yield the length and the user's name of each record."""
    for _ in range(count):
        file.seek(start)
        _, name, _, length = struct.unpack_from("<H16sHH", file.read(_RECORD_HEADER))
        yield length, name.rstrip(b"\0")
        start += _RECORD_HEADER + length


def _check_extended(file: IO[bytes], start: int, count: int, size: int) -> None:
    """Check the records behind the points."""
    if count and (start > size or count * _EXTENDED_HEADER > size - start):
        raise _DamageError(f"its header promises {count} records from byte {start} on")
    for _ in range(count):
        file.seek(start)
        head = file.read(_EXTENDED_HEADER)
        if len(head) < _EXTENDED_HEADER:
            raise _DamageError(f"a record behind the points begins at byte {start}")
        start += _EXTENDED_HEADER + int(struct.unpack_from("<Q", head, 20)[0])
        if start > size:
            raise _DamageError(f"a record behind the points ends at byte {start}")


def _check_chunks(file: IO[bytes], points_at: int, size: int) -> None:
    """Check that the table of chunks is in the file and that each chunk can have a byte."""
    table_at = _number(file, "<q", points_at)
    if table_at == _CHUNK_TABLE_AT_END:
        table_at = _number(file, "<q", size - 8)
    if not points_at + 8 <= table_at <= size - 8:
        raise _DamageError(f"its table of chunks begins at byte {table_at}")
    chunks = _number(file, "<I", table_at + 4)
    if chunks > table_at - points_at:
        raise _DamageError(f"it promises {chunks} chunks in {table_at - points_at} bytes of points")


def _number(file: IO[bytes], kind: str, at: int) -> int:
    file.seek(max(0, at))
    data = file.read(struct.calcsize(kind))
    if len(data) < struct.calcsize(kind):
        raise _DamageError(f"it ends before byte {at + struct.calcsize(kind)}")
    return int(struct.unpack(kind, data)[0])
