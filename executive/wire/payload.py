"""Observations and commands as a JSON object and a block of numbers, and back.

A message is an object of its class `type` and its fields; an array is `{"shape": […]}`, and its
numbers are the next ones of the block, as 64-bit floats, little-endian, in order of rows.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from executive.messages.command import Command, Drive, Follow, LimitStop, MoveJaws, SwitchLidars
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.messages.trajectory import JointTrajectory
from executive.wire.frame import WireError

_CLASSES: Mapping[str, type] = {
    one.__name__: one
    for one in (
        ImuSample,
        GnssFix,
        JointSample,
        LidarScan,
        Follow,
        LimitStop,
        MoveJaws,
        SwitchLidars,
        Drive,
        JointTrajectory,
    )
}
_NUMBER = np.dtype("<f8")


def pack(messages: Iterable[Observation | Command]) -> tuple[list[dict[str, Any]], bytes]:
    """Return the objects of messages, and the block that they refer to."""
    blocks: list[bytes] = []
    objects = [_object(one, blocks) for one in messages]
    return objects, b"".join(blocks)


def unpack(objects: object, body: bytes, offset_s: float = 0.0) -> list[Any]:
    """Return the messages.

    Args:
        objects: What `pack` returned first.
        body: What it returned second.
        offset_s: What is subtracted from every stamp [s]: the machine's time at the mission's
            start.

    Raises:
        WireError: If something is no message; the text says what.
    """
    block = _Block(body)
    if not isinstance(objects, list):
        raise WireError(f"expected a list of messages, got {type(objects).__name__}")
    try:
        return [_message(one, block, offset_s) for one in objects]
    except WireError:
        raise
    except Exception as error:  # whatever the class of a message refuses
        raise WireError(f"no message: {type(error).__name__}: {error}") from error


def _object(value: Any, blocks: list[bytes]) -> dict[str, Any]:
    found: dict[str, Any] = {"type": type(value).__name__}
    for one in fields(value):
        part = getattr(value, one.name)
        if isinstance(part, np.ndarray):
            blocks.append(np.ascontiguousarray(part, dtype=_NUMBER).tobytes())
            found[one.name] = {"shape": list(part.shape)}
        elif is_dataclass(part):
            found[one.name] = _object(part, blocks)
        else:
            found[one.name] = part
    return found


class _Block:
    def __init__(self, body: bytes) -> None:
        if len(body) % _NUMBER.itemsize:
            raise WireError(f"a block of {len(body)} bytes holds no whole number of floats")
        self._numbers = np.frombuffer(body, dtype=_NUMBER)
        self._used = 0

    def take(self, shape: Sequence[int]) -> Any:
        count = math.prod(shape)
        if any(not isinstance(one, int) or one < 0 for one in shape):
            raise WireError(f"a shape is a list of counts, not {list(shape)}")
        if self._used + count > len(self._numbers):
            raise WireError(f"a block of {len(self._numbers)} numbers is too short")
        found = self._numbers[self._used : self._used + count]
        self._used += count
        return np.array(found, dtype=np.float64).reshape(shape)


def _message(found: Any, block: _Block, offset_s: float) -> Any:
    kind = _CLASSES.get(found.get("type", "")) if isinstance(found, dict) else None
    if kind is None:
        raise WireError(f"no message of a known type: {str(found)[:80]}")
    parts = {
        key: _part(key, value, block, offset_s) for key, value in found.items() if key != "type"
    }
    return kind(**parts)


def _part(key: str, value: Any, block: _Block, offset_s: float) -> Any:
    if isinstance(value, dict) and "shape" in value:
        array = block.take(value["shape"])
        return array - offset_s if key.endswith("stamps_s") else array
    if isinstance(value, dict):
        return _message(value, block, offset_s)
    if isinstance(value, list):
        return tuple(value)
    return value - offset_s if key == "stamp_s" else value
