"""Records of an MCAP file: kind, length, content; and chunks, which hold records in packed form.

Lengths are checked against what is there before anything of that length is made. Source: MCAP
specification, "Records" (mcap.dev/spec).
"""

import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import BytesIO
from typing import IO, TypeVar

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream

SCHEMA, CHANNEL, MESSAGE, CHUNK, METADATA, DATA_END = 0x03, 0x04, 0x05, 0x06, 0x0C, 0x0F
HEAD = struct.Struct("<BQ")  # kind and length of a record
MESSAGE_HEAD = struct.Struct("<HIQQ")  # channel, sequence, log time [ns], publish time [ns]
_CHUNK_HEAD = struct.Struct("<QQQII")  # first and last time [ns], unpacked size, checksum, length
_LARGEST_CHUNK = 64_000_000  # bytes; writers make chunks of 1 to 4 MB

_Record = TypeVar("_Record")


class BrokenRecordError(ValueError):
    """A record is cut off, or its content is not what its head says."""


@dataclass(frozen=True, slots=True)
class ChunkHead:
    """What a chunk says of itself.

    Attributes:
        first_ns: Time of its earliest message [ns].
        last_ns: Time of its latest message [ns].
    """

    first_ns: int
    last_ns: int


def parsed(kind: Callable[[ReadDataStream], _Record], content: bytes) -> _Record:
    """Return a record from its content, by the `read` of its class in the package `mcap`."""
    return kind(ReadDataStream(BytesIO(content)))


def read_record(file: IO[bytes], at: int, size: int) -> tuple[int, bytes]:
    """Return kind and content of the record at a byte of a file.

    Raises:
        BrokenRecordError: If the file ends before the record does.
    """
    file.seek(at)
    head = file.read(HEAD.size)
    kind, length = HEAD.unpack(head) if len(head) == HEAD.size else (0, size)
    if at + HEAD.size + length > size:
        raise BrokenRecordError(f"the record at byte {at} ends behind the end of the file")
    return kind, file.read(length)


def records_in(data: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield kind, start and end of the content of each record.

    Raises:
        BrokenRecordError: If the last one is cut off.
    """
    at, size = 0, len(data)
    while at < size:
        if at + HEAD.size > size:
            raise BrokenRecordError(f"a record is cut off at byte {at}")
        kind, length = HEAD.unpack_from(data, at)
        start, at = at + HEAD.size, at + HEAD.size + length
        if at > size or (kind == MESSAGE and length < MESSAGE_HEAD.size):
            raise BrokenRecordError(f"a record of {length} bytes begins at byte {start} of {size}")
        yield kind, start, at


def unpacked(content: bytes) -> tuple[ChunkHead, bytes]:
    """Return the head of a chunk and its records.

    Raises:
        BrokenRecordError: If its content is damaged, or it is too large.
        zstandard.ZstdError: If it is damaged.
        RuntimeError: If it is damaged.
    """
    if len(content) < _CHUNK_HEAD.size:
        raise BrokenRecordError("a chunk without a head")
    first_ns, last_ns, size, checksum, length = _CHUNK_HEAD.unpack_from(content)
    at = _CHUNK_HEAD.size + length
    packing = content[_CHUNK_HEAD.size : at].decode("ascii", errors="replace")
    packed = content[at + 8 :]
    if int.from_bytes(content[at : at + 8], "little") != len(packed):
        raise BrokenRecordError("a chunk has another length than its head says")
    if size > _LARGEST_CHUNK:
        raise BrokenRecordError(
            f"a chunk of {size:,} bytes, and {_LARGEST_CHUNK:,} are the most: write the log again "
            "with smaller chunks, such as by `mcap compress --chunk-size 4000000`"
        )
    data = _data(packing, packed, size)
    if len(data) != size or (checksum and zlib.crc32(data) != checksum):
        raise BrokenRecordError("a chunk's checksum or size does not fit its content")
    return ChunkHead(first_ns, last_ns), data


def _data(packing: str, packed: bytes, size: int) -> bytes:
    """Unpack at most one byte more than there should be, whatever the packed data claim."""
    if packing == "zstd":
        reader = zstandard.ZstdDecompressor().stream_reader(packed)
        return bytes(reader.read(size + 1))
    if packing == "lz4":
        return bytes(lz4.frame.LZ4FrameDecompressor().decompress(packed, size + 1))
    if packing:
        raise BrokenRecordError(f"a chunk is packed by '{packing}'; zstd and lz4 are read")
    return packed
