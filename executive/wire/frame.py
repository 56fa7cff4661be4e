"""Frames of the robot wire: a header of 16 bytes, a JSON object, and a block of binary numbers.

docs/robot_wire.md describes them for those who write a machine's end in another language. This file
uses the standard library alone, because the supervisor has to start at once and stay small.
"""

import json
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

from executive.errors import RobotError

MAGIC = b"EXRW"
VERSION = 1
_HEADER = struct.Struct("<4sBBHII")  # magic, version, kind, 0, sequence, length of what follows
_LENGTH = struct.Struct("<I")  # length of the JSON object
LARGEST_BYTES = 64 * 2**20  # two revolutions of a lidar are 2 MB


class Kind(IntEnum):
    """What a frame is; who sends it is in docs/robot_wire.md."""

    HELLO = 1
    WELCOME = 2
    ALIVE = 3
    COMMAND = 4
    STOP = 5
    RESUME = 6
    SAFE_STOP = 7
    RESET = 8
    DONE = 9
    REFUSED = 10
    OBSERVATIONS = 11
    STATUS = 12
    PAUSED = 13
    RESUMED = 14
    SURVEY = 15
    CLOUD = 16


class WireError(RobotError):
    """The other end speaks another language or version, or does not answer."""


@dataclass(frozen=True, slots=True)
class Frame:
    """One message.

    Attributes:
        kind: What it is.
        head: Its JSON object.
        body: Binary numbers that the object refers to.
        sequence: Number given by the sender; an answer has that of its question.
    """

    kind: Kind
    head: dict[str, Any] = field(default_factory=dict)
    body: bytes = b""
    sequence: int = 0

    def packed(self) -> bytes:
        """Return the frame as it is sent."""
        head = json.dumps(self.head, separators=(",", ":"), allow_nan=False).encode()
        payload = _LENGTH.pack(len(head)) + head + self.body
        header = _HEADER.pack(MAGIC, VERSION, self.kind, 0, self.sequence, len(payload))
        return header + payload


class FrameReader:
    """Puts frames together from what arrives."""

    def __init__(self) -> None:
        self._buffer = bytearray()

    def feed(self, data: bytes) -> Iterator[Frame]:
        """Yield the frames that are complete.

        Raises:
            WireError: If this is no frame of this version; the connection is of no use then.
        """
        self._buffer += data
        while len(self._buffer) >= _HEADER.size:
            magic, version, kind, _, sequence, length = _HEADER.unpack_from(self._buffer)
            _check(bytes(magic), version, kind, length)
            end = _HEADER.size + length
            if len(self._buffer) < end:
                return
            payload = bytes(self._buffer[_HEADER.size : end])
            del self._buffer[:end]
            yield _unpacked(Kind(kind), sequence, payload)


def _check(magic: bytes, version: int, kind: int, length: int) -> None:
    if magic != MAGIC:
        raise WireError(f"no frame of the robot wire: it begins with {magic!r}, not {MAGIC!r}")
    if version != VERSION:
        raise WireError(f"version {version} of the robot wire; this program speaks {VERSION}")
    if kind not in Kind._value2member_map_:
        raise WireError(f"kind {kind} is none of version {VERSION} of the robot wire")
    if not _LENGTH.size <= length <= LARGEST_BYTES:
        raise WireError(f"a frame of {length} bytes; {LARGEST_BYTES} are the most")


def _unpacked(kind: Kind, sequence: int, payload: bytes) -> Frame:
    (length,) = _LENGTH.unpack_from(payload)
    end = _LENGTH.size + length
    if end > len(payload):
        raise WireError(f"a frame whose JSON object of {length} bytes is longer than the frame")
    try:
        head = json.loads(payload[_LENGTH.size : end])
    except (ValueError, RecursionError) as error:
        raise WireError(f"a frame of kind {kind.name} holds no JSON object: {error}") from error
    if not isinstance(head, dict):
        raise WireError(f"a frame of kind {kind.name} holds {type(head).__name__}, no JSON object")
    return Frame(kind, head, payload[end:], sequence)
