"""A value's content as bytes, for comparing answers bit for bit and for noticing changed inputs."""

import hashlib
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike

from executive.arrays import Float, checked
from executive.messages.parts import parts


def digest(value: object) -> str:
    """Return a hash of everything in a value: messages, arrays, mappings, sequences, scalars.

    Fields that hold measured wall times are left out.

    Raises:
        TypeError: If a part has no content that could be compared, such as a function or a handle.
    """
    hasher = hashlib.sha256()
    for path, part in parts(value):
        hasher.update(path.encode())
        hasher.update(content(part))
    return hasher.hexdigest()


def first_difference(a: object, b: object) -> str:
    """Return where two values differ first, such as `segments[0].points`; empty if nowhere."""
    for (path_a, part_a), (path_b, part_b) in zip(parts(a), parts(b), strict=False):
        if path_a != path_b or content(part_a) != content(part_b):
            return path_a or "the value"
    return "" if digest(a) == digest(b) else "the number of parts"


def locked(values: ArrayLike) -> Float:
    """Return a read-only array of its own, as a mission hands arrays over."""
    array = np.array(values, dtype=np.float64)
    return checked("values", array, *array.shape)


def content(part: object) -> bytes:
    """Return the bytes of one leaf of a value: an array, a number, a text, a flag or nothing.

    Raises:
        TypeError: If it has no content that could be compared, such as a function or a handle.
    """
    if isinstance(part, np.ndarray):
        return f"{part.dtype.str}{part.shape}".encode() + np.ascontiguousarray(part).tobytes()
    if part is None or isinstance(part, bool | int | float | str | bytes | np.generic | Enum):
        return f"{type(part).__qualname__}:{part!r}".encode()
    raise TypeError(f"a {type(part).__qualname__} has no content that can be compared")
