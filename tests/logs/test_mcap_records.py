"""Records and chunks of MCAP files: whole ones are read, and each kind of damage is told."""

import struct
import zlib
from io import BytesIO

import lz4.frame
import pytest
import zstandard

from executive.logs.mcap_records import (
    CHANNEL,
    MESSAGE,
    SCHEMA,
    BrokenRecordError,
    ChunkHead,
    read_record,
    records_in,
    unpacked,
)

BODY = b"records of a chunk, " * 20


def record(kind, content, length=None):
    return struct.pack("<BQ", kind, len(content) if length is None else length) + content


def chunk(data=BODY, packing="", packed=None, *, size=None, checksum=None, length=None):
    """Return the content of a chunk from 5 to 9 ns."""
    packed = data if packed is None else packed
    size = len(data) if size is None else size
    checksum = zlib.crc32(data) if checksum is None else checksum
    head = struct.pack("<QQQII", 5, 9, size, checksum, len(packing)) + packing.encode()
    return head + struct.pack("<Q", len(packed) if length is None else length) + packed


def test_a_record_of_a_file_is_read_at_its_byte():
    data = b"before" + record(SCHEMA, b"what") + b"behind"
    assert read_record(BytesIO(data), 6, len(data)) == (SCHEMA, b"what")
    whole = len(data) - len(b"behind")
    assert read_record(BytesIO(data), 6, whole) == (SCHEMA, b"what")


@pytest.mark.parametrize("left_out", [1, 4, 5, 12])
def test_a_record_that_ends_behind_the_file_is_told(left_out):
    data = record(SCHEMA, b"what")[:-left_out]
    with pytest.raises(BrokenRecordError, match="the record at byte 0 ends behind the end"):
        read_record(BytesIO(data), 0, len(data))


def test_records_are_told_by_kind_and_the_bytes_of_their_content():
    message = bytes(22)  # a message with a head and nothing behind it
    data = record(SCHEMA, b"abc") + record(CHANNEL, b"") + record(MESSAGE, message)
    assert list(records_in(data)) == [(SCHEMA, 9, 12), (CHANNEL, 21, 21), (MESSAGE, 30, 52)]
    assert list(records_in(b"")) == []


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (record(SCHEMA, b"abc") + b"\x03", "a record is cut off at byte 12"),
        (record(SCHEMA, b"abc", 4), "a record of 4 bytes begins at byte 9 of 12"),
        (record(MESSAGE, bytes(21)), "a record of 21 bytes begins at byte 9 of 30"),
    ],
)
def test_a_record_that_is_cut_off_is_told_with_its_byte(data, told):
    with pytest.raises(BrokenRecordError) as caught:
        list(records_in(data))
    assert str(caught.value) == told


@pytest.mark.parametrize(
    ("packing", "pack"),
    [("", bytes), ("zstd", zstandard.ZstdCompressor().compress), ("lz4", lz4.frame.compress)],
)
def test_a_chunk_is_unpacked(packing, pack):
    assert unpacked(chunk(BODY, packing, pack(BODY))) == (ChunkHead(5, 9), BODY)


def test_a_chunk_without_a_checksum_is_not_checked():
    assert unpacked(chunk(checksum=0)) == (ChunkHead(5, 9), BODY)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (chunk()[:31], "a chunk without a head"),
        (chunk(length=3), "a chunk has another length than its head says"),
        (chunk(checksum=7), "a chunk's checksum or size does not fit its content"),
        (chunk(size=len(BODY) + 1), "a chunk's checksum or size does not fit its content"),
        (chunk(packing="bz2"), "a chunk is packed by 'bz2'; zstd and lz4 are read"),
    ],
)
def test_a_chunk_that_is_damaged_is_told(content, told):
    with pytest.raises(BrokenRecordError) as caught:
        unpacked(content)
    assert str(caught.value) == told


@pytest.mark.parametrize(
    ("packing", "pack"),
    [("zstd", zstandard.ZstdCompressor().compress), ("lz4", lz4.frame.compress)],
)
def test_no_more_is_unpacked_than_the_head_says(packing, pack):
    content = chunk(b"x" * 100, packing, pack(bytes(10_000_000)), checksum=0)
    with pytest.raises(BrokenRecordError, match="checksum or size does not fit"):
        unpacked(content)


def test_the_largest_chunk_is_read_and_a_byte_more_is_refused(monkeypatch):
    monkeypatch.setattr("executive.logs.mcap_records._LARGEST_CHUNK", len(BODY))
    assert unpacked(chunk())[1] == BODY
    with pytest.raises(BrokenRecordError, match="a chunk of 401 bytes, and 400 are the most"):
        unpacked(chunk(BODY + b"x"))
