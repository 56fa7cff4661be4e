"""A value's content as bytes, for comparing answers bit for bit and for noticing changed inputs."""

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

from executive.arrays import checked

_MEASURED = ("timings_ms", "wall_s")  # wall times differ from run to run, and may


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


def place_of_nan(value: object) -> str:
    """Return where a value holds a number that is none (NaN); empty if nowhere."""
    for path, part in parts(value):
        if isinstance(part, np.ndarray) and part.dtype.kind == "f" and np.isnan(part).any():
            return path or "the value"
        if isinstance(part, float) and math.isnan(part):
            return path or "the value"
    return ""


def parts(value: object, path: str = "") -> Iterator[tuple[str, object]]:
    """Yield each leaf of a nested value with its path, in a fixed order."""
    if is_dataclass(value) and not isinstance(value, type):
        # The class is no part of the content: a subclass may be handed over as its base.
        for field in fields(value):
            if field.name not in _MEASURED:
                yield from parts(getattr(value, field.name), f"{path}.{field.name}".lstrip("."))
    elif isinstance(value, Mapping):
        yield path, len(value)
        for key in sorted(value, key=str):
            yield from parts(value[key], f"{path}[{key!r}]")
    elif isinstance(value, Sequence) and not isinstance(value, str | bytes):
        yield path, len(value)
        for i, item in enumerate(value):
            yield from parts(item, f"{path}[{i}]")
    else:
        yield path, value


def locked(values: Any) -> np.ndarray[Any, Any]:
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
