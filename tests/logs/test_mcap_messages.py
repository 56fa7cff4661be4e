"""The order of messages in MCAP files whose chunks overlap, against the package's reader."""

from io import BytesIO

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer

from executive.logs.mcap_contents import read_contents
from executive.logs.mcap_messages import in_order
from executive.logs.mcap_records import BrokenRecordError


def written(stamps_ns, chunk_size=200, index_types=IndexType.ALL, use_chunking=True) -> BytesIO:
    """A file with these messages, on /a and /b in turn and each tenth on /c, numbered in their
    content.
    """
    file = BytesIO()
    writer = Writer(
        file,
        chunk_size=chunk_size,
        compression=CompressionType.NONE,
        index_types=index_types,
        use_chunking=use_chunking,
    )
    writer.start()
    schema = writer.register_schema("Kind", "ros2msg", b"")
    channels = [writer.register_channel(topic, "cdr", schema) for topic in ("/a", "/b")]
    channels.append(writer.register_channel("/c", "cdr", 0))
    for k, stamp_ns in enumerate(stamps_ns):
        writer.add_message(
            channels[2 if k % 10 == 9 else k % 2], int(stamp_ns), str(k).encode(), int(stamp_ns)
        )
    writer.finish()
    file.seek(0)
    return file


def numbers(messages) -> list[tuple[str, int, str | None]]:
    return [
        (channel.topic, int(message.data), schema and schema.name)
        for schema, channel, message in messages
    ]


@pytest.mark.parametrize("spread_ns", [0, 3, 60, 1000])
@pytest.mark.parametrize("topics", [["/a"], ["/a", "/b", "/c"], ["/none"]])
@pytest.mark.parametrize("index_types", [IndexType.ALL, IndexType.CHUNK])
def test_the_order_equals_that_of_the_package(spread_ns, topics, index_types) -> None:
    rng = np.random.default_rng(spread_ns)
    stamps_ns = 1000 + 5 * np.arange(300) + rng.integers(0, spread_ns + 1, 300)
    file = written(stamps_ns // 2, index_types=index_types)  # some stamps are the same
    found = numbers(in_order(file, read_contents(file), topics))
    file.seek(0)
    assert found == numbers(make_reader(file).iter_messages(topics=topics))
    assert len(found) == sum({"/a": 150, "/b": 120, "/c": 30}.get(topic, 0) for topic in topics)


def test_a_file_without_chunks_is_read() -> None:
    file = written([7, 5, 6], use_chunking=False)
    found = numbers(in_order(file, read_contents(file), ["/a", "/b"]))
    assert found == [("/b", 1, "Kind"), ("/a", 2, "Kind"), ("/a", 0, "Kind")]


def test_a_chunk_whose_sum_is_wrong_is_refused() -> None:
    content = bytearray(written(range(40)).getvalue())
    content[content.index(b"21")] ^= 1
    file = BytesIO(content)
    with pytest.raises(BrokenRecordError, match="checksum"):
        list(in_order(file, read_contents(file), ["/a", "/b"]))
