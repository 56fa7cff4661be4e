"""Messages of an MCAP file in order of their time, with few chunks in memory."""

from collections.abc import Iterator, Sequence
from heapq import merge
from operator import itemgetter
from typing import IO

from mcap.records import Channel, Message, Schema

from executive.logs.mcap_contents import Contents, Part
from executive.logs.mcap_records import HEAD, MESSAGE, MESSAGE_HEAD, records_in, unpacked

# Time [ns], byte at which the part begins, number within the part, message.
_Placed = tuple[int, int, int, Message]
_order = itemgetter(0, 1, 2)


def in_order(
    file: IO[bytes], contents: Contents, topics: Sequence[str]
) -> Iterator[tuple[Schema | None, Channel, Message]]:
    """Yield schema, channel and message of some topics; the checksums of chunks are verified.

    A part is read when the messages before it have been yielded, so that those of few parts are in
    memory: most chunks follow one another in time.

    Raises:
        Exception: Various types, which the package `mcap` and unpackers raise on a damaged file.
    """
    channels = {
        channel.id: channel for channel in contents.channels.values() if channel.topic in topics
    }
    wanted = [
        part
        for part in contents.parts
        if not part.channels or not channels.keys().isdisjoint(part.channels)
    ]
    for _, _, _, message in _merged(file, wanted, frozenset(channels)):
        channel = channels[message.channel_id]
        schema = contents.schemas[channel.schema_id] if channel.schema_id else None
        yield schema, channel, message


def _merged(file: IO[bytes], parts: Sequence[Part], channels: frozenset[int]) -> Iterator[_Placed]:
    waiting: list[_Placed] = []
    for part in sorted(parts, key=lambda part: (part.first_ns, part.start)):
        ready = 0
        while ready < len(waiting) and waiting[ready][0] < part.first_ns:
            ready += 1
        yield from waiting[:ready]
        found = sorted(_messages(file, part, channels), key=_order)
        rest = waiting[ready:]
        waiting = list(merge(rest, found, key=_order)) if rest else found
    yield from waiting


def _messages(file: IO[bytes], part: Part, channels: frozenset[int]) -> Iterator[_Placed]:
    file.seek(part.start + HEAD.size if part.is_chunk else part.start)
    data = file.read(part.end - file.tell())
    if part.is_chunk:
        _, data = unpacked(data)
    for number, (kind, start, end) in enumerate(records_in(data)):
        if kind != MESSAGE:
            continue
        channel, sequence, log_ns, publish_ns = MESSAGE_HEAD.unpack_from(data, start)
        if channel in channels:
            content = data[start + MESSAGE_HEAD.size : end]
            message = Message(
                channel_id=channel,
                log_time=log_ns,
                data=content,
                publish_time=publish_ns,
                sequence=sequence,
            )
            yield log_ns, part.start, number, message
