"""The parts of a value: the arrays, numbers and texts that a message or a container is made of."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from itertools import islice

import numpy as np

_MEASURED = ("timings_ms", "wall_s")  # wall times differ from run to run, and may


def place_of_nan(value: object, most: int | None = None) -> str:
    """Return where a value holds a number that is none (NaN); empty if nowhere.

    Args:
        value: A message, or what is made of arrays, numbers, sequences and mappings.
        most: How many parts are looked at; all by default. An array is one part.
    """
    for path, part in islice(parts(value), most):
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
