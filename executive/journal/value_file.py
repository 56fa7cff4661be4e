"""Values as bytes: a head in JSON with the form of each array, then the arrays."""

import json
import struct
from typing import Any

import numpy as np

from executive.errors import DataError
from executive.journal.value_codec import decode, encode

_HEAD = struct.Struct("<8sQ")  # mark, length of the JSON
_MAGIC = b"kept v1\n"


def to_bytes(value: Any) -> bytes:
    """Return a value as bytes; equal values give equal bytes.

    Raises:
        NotKeptError: If a part of it cannot be kept.
    """
    arrays: list[np.ndarray] = []
    tree = encode(value, arrays)
    forms = [[one.dtype.newbyteorder("<").str, list(one.shape)] for one in arrays]
    head = json.dumps({"value": tree, "arrays": forms}, separators=(",", ":")).encode()
    raw = [one.astype(one.dtype.newbyteorder("<"), copy=False).tobytes() for one in arrays]
    return b"".join([_HEAD.pack(_MAGIC, len(head)), head, *raw])


def from_bytes(data: bytes) -> Any:
    """Return the value of `to_bytes`; its arrays are its own.

    Raises:
        DataError: If these are no such bytes, or they are cut off.
    """
    try:
        mark, length = _HEAD.unpack_from(data)
        head = json.loads(data[_HEAD.size : _HEAD.size + length])
        arrays, at = [], _HEAD.size + length
        for kind, shape in head["arrays"]:
            dtype = np.dtype(kind)
            count = int(np.prod(shape, dtype=np.int64))
            if dtype.hasobject or at + count * dtype.itemsize > len(data):
                raise DataError("a kept value is cut off")
            arrays.append(np.frombuffer(data, dtype, count, at).reshape(shape).copy())
            at += count * dtype.itemsize
        if mark != _MAGIC or at != len(data):
            raise DataError("not a kept value, or one that is cut off")
        return decode(head["value"], arrays)
    except (struct.error, ValueError, KeyError, TypeError, RecursionError) as error:
        raise DataError(f"not a kept value: {error}") from error
