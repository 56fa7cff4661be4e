"""What an MCAP file holds is found from its summary, or record by record where it has none."""

import struct
from io import BytesIO

import pytest
from mcap.writer import CompressionType, IndexType, Writer

from executive.logs.mcap_contents import Cut, NoMcapError, read_contents
from executive.logs.mcap_records import (
    CHUNK,
    DATA_END,
    MESSAGE,
    BrokenRecordError,
    read_record,
)

MAGIC = b"\x89MCAP0\r\n"


def written(count=6, *, chunks=True, summary=True, chunk_size=100):
    """Return a file of messages on two channels, at 10, 20, … ns."""
    file = BytesIO()
    writer = Writer(
        file,
        chunk_size=chunk_size,
        compression=CompressionType.NONE,
        use_chunking=chunks,
        index_types=IndexType.ALL if summary else IndexType.NONE,
        use_summary_offsets=summary,
        use_statistics=summary,
        repeat_channels=summary,
        repeat_schemas=summary,
    )
    writer.start()
    schema = writer.register_schema("kind", "jsonschema", b"{}")
    channels = [writer.register_channel(f"/{name}", "json", schema) for name in "ab"]
    for i in range(count):
        writer.add_message(channels[i % 2], 10 * (i + 1), b"x" * 40, 10 * (i + 1))
    writer.add_metadata("about", {"site": "yard"})
    writer.finish()
    return file.getvalue()


def places(data, wanted):
    """Return where the records of a kind begin and end."""
    found, at = [], len(MAGIC)
    while at < len(data) - len(MAGIC):
        kind, content = read_record(BytesIO(data), at, len(data))
        end = at + 9 + len(content)
        if kind == wanted:
            found.append((at, end))
        at = end
    return found


def contents(data):
    return read_contents(BytesIO(data))


def test_a_summary_and_a_walk_find_the_same():
    found, walked = contents(written()), contents(written(summary=False))
    for one in (found, walked):
        assert [channel.topic for channel in one.channels.values()] == ["/a", "/b"]
        assert [schema.name for schema in one.schemas.values()] == ["kind"]
        assert [(each.name, each.metadata) for each in one.metadata] == [
            ("about", {"site": "yard"})
        ]
        assert one.cut is None
    assert len(found.parts) > 1
    for one, other in zip(found.parts, walked.parts, strict=True):
        assert (one.first_ns, one.channels) == (other.first_ns, other.channels)


@pytest.mark.parametrize("summary", [True, False])
def test_parts_are_the_chunks_with_their_earliest_times_and_channels(summary):
    data = written(summary=summary)
    found = contents(data)
    assert [(part.start, part.end) for part in found.parts] == places(data, CHUNK)
    assert all(part.is_chunk for part in found.parts)
    assert found.parts[0].first_ns == 10
    assert set().union(*(part.channels for part in found.parts)) == set(found.channels)


def test_messages_outside_of_chunks_are_one_part_as_long_as_they_follow_each_other():
    data = written(chunks=False, summary=False)
    messages = places(data, MESSAGE)
    found = contents(data)
    # The second channel is registered before the first message, so all messages are in a row.
    (part,) = found.parts
    assert (part.start, part.end) == (messages[0][0], messages[-1][1])
    assert (part.first_ns, part.is_chunk, part.channels) == (10, False, frozenset())


def test_a_long_row_of_messages_is_read_in_parts(monkeypatch):
    data = written(chunks=False, summary=False)
    messages = places(data, MESSAGE)
    length = messages[0][1] - messages[0][0]
    monkeypatch.setattr("executive.logs.mcap_contents._RUN_BYTES", 2 * length)
    found = contents(data)
    assert [part.start for part in found.parts] == [messages[0][0], messages[3][0]]
    assert [part.first_ns for part in found.parts] == [10, 40]
    assert found.parts[0].end == found.parts[1].start


@pytest.mark.parametrize("chunks", [True, False])
def test_a_file_that_is_cut_off_is_read_to_its_last_whole_record(chunks):
    data = written(chunks=chunks)
    (_, before), (begin, end), *_ = places(data, CHUNK if chunks else MESSAGE)
    for cut in (begin + 1, end - 1):
        found = contents(data[:cut])
        assert found.cut is not None
        assert (found.cut.read_bytes, found.cut.file_bytes) == (begin, cut)
        assert [channel.topic for channel in found.channels.values()][:1] == ["/a"]
        assert found.parts[-1].end == before


def test_a_cut_file_tells_the_time_of_its_last_message():
    data = written(chunks=False)
    begin, _ = places(data, MESSAGE)[4]
    assert contents(data[:begin]).cut == Cut(begin, begin, 40)
    # Zeros behind it are what a file system leaves.
    assert contents(data[:begin] + bytes(50)).cut == Cut(begin, begin + 50, 40)


def test_a_cut_file_is_whole_up_to_the_end_of_its_data():
    data = written(chunks=False)
    ((begin, end),) = places(data, DATA_END)
    found = contents(data[:end])
    assert found.cut == Cut(begin, end, 60)
    assert len(found.metadata) == 1


@pytest.mark.parametrize("data", [b"", MAGIC[:-1], b"ply\n", b"X" + written()[1:]])
def test_another_file_is_told(data):
    with pytest.raises(NoMcapError, match="does not begin as an MCAP file does"):
        contents(data)


def test_a_beginning_alone_is_a_file_that_was_cut_off():
    assert contents(MAGIC).cut == Cut(8, 8, 0)
    assert contents(MAGIC).parts == []


def test_a_whole_file_whose_end_is_no_footer_is_refused():
    data = bytearray(written())
    data[-len(MAGIC) - 29] = 0x0E
    with pytest.raises(BrokenRecordError, match="its last record is not the footer"):
        contents(bytes(data))


def test_an_index_that_leads_behind_the_file_is_refused():
    data = bytearray(written())
    (begin, _), *_ = places(bytes(data), 0x08)
    struct.pack_into("<Q", data, begin + 9 + 16, 10**6)  # where its chunk begins
    with pytest.raises(BrokenRecordError, match="its index has a chunk that ends at byte 1000"):
        contents(bytes(data))


def test_a_whole_file_with_a_damaged_record_is_refused_and_a_cut_one_is_read_up_to_it():
    data = bytearray(written(chunks=False, summary=False))
    begin, _ = places(bytes(data), MESSAGE)[3]
    data[begin] = 0
    with pytest.raises(BrokenRecordError, match=f"at byte {begin} no record begins"):
        contents(bytes(data))
    assert contents(bytes(data[:-1])).cut == Cut(begin, len(data) - 1, 30)


def test_a_message_without_a_head_is_refused():
    data = written(chunks=False, summary=False)
    begin, end = places(data, MESSAGE)[3]
    short = data[:begin] + struct.pack("<BQ", MESSAGE, 21) + bytes(21) + data[end:]
    with pytest.raises(BrokenRecordError, match=f"the message at byte {begin} has no head"):
        contents(short)
