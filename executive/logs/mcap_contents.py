"""What an MCAP file holds: from its summary or, where a recorder was killed, from its records."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import IO

from mcap.exceptions import McapError
from mcap.records import Channel, ChunkIndex, Footer, Metadata, MetadataIndex, Schema
from zstandard import ZstdError

from executive.logs.mcap_records import (
    CHANNEL,
    CHUNK,
    DATA_END,
    HEAD,
    MESSAGE,
    MESSAGE_HEAD,
    METADATA,
    SCHEMA,
    BrokenRecordError,
    parsed,
    read_record,
    records_in,
    unpacked,
)

_MAGIC = b"\x89MCAP0\r\n"
_FOOTER, _CHUNK_INDEX, _METADATA_INDEX = 0x02, 0x08, 0x0D
_FOOTER_BYTES = HEAD.size + 20
_RUN_BYTES = 1 << 20  # of messages outside of chunks that are read at a time
_KINDS = range(0x01, 0x80)  # of records; 0 is what a file system leaves at the end of a cut file


class NoMcapError(ValueError):
    """The file does not begin as an MCAP file does."""


@dataclass(frozen=True, slots=True)
class Cut:
    """Where a log was cut off.

    Attributes:
        read_bytes: Number of bytes that are read.
        file_bytes: Size of the file.
        last_ns: Time of the latest message that is read [ns].
    """

    read_bytes: int
    file_bytes: int
    last_ns: int


@dataclass(frozen=True, slots=True)
class Part:
    """A chunk, or messages that follow each other outside of chunks.

    Attributes:
        start: Byte at which it begins.
        end: Byte behind its end.
        first_ns: Time of its earliest message [ns].
        channels: The channels of its messages; empty if not known.
        is_chunk: Whether it is a chunk.
    """

    start: int
    end: int
    first_ns: int
    channels: frozenset[int]
    is_chunk: bool


@dataclass(slots=True)
class Contents:
    """What is where in a file.

    Attributes:
        schemas: Schemas by number.
        channels: Channels by number.
        metadata: Metadata records.
        parts: Where messages are, in the order of the file.
        cut: Where the file was cut off; None if it is whole.
    """

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: list[Metadata] = field(default_factory=list)
    parts: list[Part] = field(default_factory=list)
    cut: Cut | None = None


def read_contents(file: IO[bytes]) -> Contents:
    """Return what a file holds.

    A file with a summary is not read as a whole. One without, or that was cut off, is read from its
    beginning to its end or to the first record that is not whole.

    Raises:
        NoMcapError: If it is no MCAP file.
        BrokenRecordError: If a whole file has a summary that is damaged.
        Exception: Others, which the package `mcap` raises on damaged records.
    """
    size = file.seek(0, 2)
    file.seek(0)
    if file.read(len(_MAGIC)) != _MAGIC:
        raise NoMcapError("it does not begin as an MCAP file does")
    file.seek(max(0, size - len(_MAGIC)))
    if file.read() != _MAGIC or size < 2 * len(_MAGIC) + _FOOTER_BYTES:
        return _walked(file, size, is_cut=True)
    end = size - len(_MAGIC)
    kind, content = read_record(file, end - _FOOTER_BYTES, end)
    if kind != _FOOTER:
        raise BrokenRecordError("its last record is not the footer")
    start = parsed(Footer.read, content).summary_start
    found = _summary(file, start, end) if start else Contents()
    return found if found.parts else _walked(file, end, is_cut=False)


def _summary(file: IO[bytes], start: int, end: int) -> Contents:
    found = Contents()
    while start < end:
        kind, content = read_record(file, start, end)
        start += HEAD.size + len(content)
        if kind == _CHUNK_INDEX:
            found.parts.append(_indexed(parsed(ChunkIndex.read, content), end))
        elif kind == _METADATA_INDEX:
            at = parsed(MetadataIndex.read, content).offset
            _take(found, *read_record(file, at, end))
        else:
            _take(found, kind, content)
    return found


def _indexed(index: ChunkIndex, size: int) -> Part:
    end = index.chunk_start_offset + index.chunk_length
    if end > size:
        raise BrokenRecordError(f"its index has a chunk that ends at byte {end} of {size}")
    channels = frozenset(index.message_index_offsets)
    return Part(index.chunk_start_offset, end, index.message_start_time, channels, True)


def _take(found: Contents, kind: int, content: bytes) -> None:
    if kind == SCHEMA:
        schema = parsed(Schema.read, content)
        found.schemas[schema.id] = schema
    elif kind == CHANNEL:
        channel = parsed(Channel.read, content)
        found.channels[channel.id] = channel
    elif kind == METADATA:
        found.metadata.append(parsed(Metadata.read, content))


def _walked(file: IO[bytes], size: int, *, is_cut: bool) -> Contents:
    """Read the records one by one, to the end of the data or to the first that is not whole."""
    found = Contents()
    at, last_ns = len(_MAGIC), 0
    run = _Run(found.parts)
    try:
        for kind, start, content in _records(file, at, size):
            at = start
            if kind == CHUNK:
                last_ns = max(last_ns, _take_chunk(found, start, content))
            elif kind == MESSAGE:
                last_ns = max(last_ns, run.add(start, content))
            else:
                _take(found, kind, content)
            at = start + HEAD.size + len(content)
    except (BrokenRecordError, McapError, ZstdError, RuntimeError, struct.error, ValueError):
        if not is_cut:
            raise
    run.close()
    if is_cut:
        found.cut = Cut(at, size, last_ns)
    return found


def _records(file: IO[bytes], at: int, size: int) -> Iterator[tuple[int, int, bytes]]:
    while at < size:
        kind, content = read_record(file, at, size)
        if kind not in _KINDS:
            raise BrokenRecordError(f"at byte {at} no record begins")
        if kind == DATA_END:
            return
        yield kind, at, content
        at += HEAD.size + len(content)


def _take_chunk(found: Contents, start: int, content: bytes) -> int:
    """Note a chunk, and the schemas and channels in it; return the time of its last message."""
    head, data = unpacked(content)
    channels, last_ns = set(), 0
    for kind, first, end in records_in(data):
        if kind == MESSAGE:
            channel, _, log_ns, _ = MESSAGE_HEAD.unpack_from(data, first)
            channels.add(channel)
            last_ns = max(last_ns, log_ns)
        else:
            _take(found, kind, data[first:end])
    end = start + HEAD.size + len(content)
    found.parts.append(Part(start, end, head.first_ns, frozenset(channels), True))
    return last_ns


class _Run:
    """Messages outside of chunks, gathered to parts of limited size."""

    def __init__(self, parts: list[Part]) -> None:
        self._parts = parts
        self._start = self._end = self._first_ns = 0

    def add(self, start: int, content: bytes) -> int:
        """Add a message and return its time [ns]."""
        if len(content) < MESSAGE_HEAD.size:
            raise BrokenRecordError(f"the message at byte {start} has no head")
        if start != self._end or start - self._start > _RUN_BYTES:
            self.close()
            self._start = start
        log_ns = int(MESSAGE_HEAD.unpack_from(content)[2])
        self._first_ns = min(self._first_ns, log_ns) if self._end > self._start else log_ns
        self._end = start + HEAD.size + len(content)
        return log_ns

    def close(self) -> None:
        """End the part."""
        if self._end > self._start:
            part = Part(self._start, self._end, self._first_ns, frozenset(), False)
            self._parts.append(part)
        self._start = self._end = 0
