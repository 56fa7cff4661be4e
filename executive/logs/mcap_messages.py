"""Messages of an MCAP file in order of their time, with few chunks in memory."""

from collections.abc import Iterator, Sequence
from typing import IO

from mcap.data_stream import ReadDataStream
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, ChunkIndex, Message, Schema
from mcap.stream_reader import breakup_chunk

_TO_CONTENT = 9  # bytes for kind and length of a record


def in_order(
    file: IO[bytes], topics: Sequence[str]
) -> Iterator[tuple[Schema | None, Channel, Message]]:
    """Yield schema, channel and message of some topics; the checksums of chunks are verified.

    Most chunks follow one another in time, so that only messages of overlapping chunks must be
    sorted. The package's own reader passes each message through a heap, which takes three times as
    long.

    Raises:
        Exception: Various types, which the package raises on a damaged file.
    """
    reader = make_reader(file, validate_crcs=True)
    summary = reader.get_summary()
    if summary is None or not summary.chunk_indexes:
        yield from reader.iter_messages(topics=topics)
        return
    channels = {
        channel.id: channel for channel in summary.channels.values() if channel.topic in topics
    }
    wanted = [
        chunk
        for chunk in summary.chunk_indexes
        if not chunk.message_index_offsets
        or not channels.keys().isdisjoint(chunk.message_index_offsets)
    ]
    for chunks in _overlapping(wanted):
        messages = [
            m for chunk in chunks for m in _messages(file, chunk) if m.channel_id in channels
        ]
        messages.sort(key=lambda message: message.log_time)
        for message in messages:
            channel = channels[message.channel_id]
            yield (
                summary.schemas[channel.schema_id] if channel.schema_id else None,
                channel,
                message,
            )


def _overlapping(chunks: Sequence[ChunkIndex]) -> Iterator[list[ChunkIndex]]:
    """Yield groups of chunks that overlap in time, earliest first, each in order of the file."""
    run: list[ChunkIndex] = []
    end_ns = 0
    for chunk in sorted(
        chunks, key=lambda chunk: (chunk.message_start_time, chunk.chunk_start_offset)
    ):
        if run and chunk.message_start_time > end_ns:
            yield sorted(run, key=lambda chunk: chunk.chunk_start_offset)
            run = []
        end_ns = max(end_ns, chunk.message_end_time) if run else chunk.message_end_time
        run.append(chunk)
    if run:
        yield sorted(run, key=lambda chunk: chunk.chunk_start_offset)


def _messages(file: IO[bytes], chunk: ChunkIndex) -> list[Message]:
    file.seek(chunk.chunk_start_offset + _TO_CONTENT)
    records = breakup_chunk(Chunk.read(ReadDataStream(file)), validate_crc=True)
    return [record for record in records if isinstance(record, Message)]
