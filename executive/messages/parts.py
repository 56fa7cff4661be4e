"""The parts of a value: the arrays, numbers and texts that a message or a container is made of."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from itertools import islice
from typing import Any, cast

import numpy as np

from executive.arrays import all_finite

_MEASURED = ("timings_ms", "wall_s")  # wall times differ from run to run, and may


def place_of_nan(value: object, most: int | None = None) -> str:
    """Return where a value holds a number that is none (NaN); empty if nowhere.

    Args:
        value: A message, or what is made of arrays, numbers, sequences and mappings.
        most: How many parts are looked at; all by default. An array is one part.
    """
    if _is_plainly_sound(value):
        return ""
    for path, part in islice(parts(value), most):
        if isinstance(part, np.ndarray) and part.dtype.kind == "f" and np.isnan(part).any():
            return path or "the value"
        if isinstance(part, float) and math.isnan(part):
            return path or "the value"
    return ""


def _is_plainly_sound(value: object) -> bool:
    """Return whether a message of arrays, numbers and texts alone is finite; a quick test.

    Answers of stream verbs are looked at hundreds of times in a second of mission.
    """
    names = _field_names(cast(Any, type(value)))
    return bool(names) and all(_is_plain(getattr(value, name)) for name in names)


def _is_plain(part: object) -> bool:
    if isinstance(part, np.ndarray):
        return all_finite(part)
    return math.isfinite(part) if type(part) is float else part is None or type(part) in (str, int)


@cache
def _field_names(of: type[Any]) -> tuple[str, ...]:
    return tuple(field.name for field in fields(of)) if is_dataclass(of) else ()


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
