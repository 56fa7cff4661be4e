"""Turn answers into JSON, and compare such JSON with what was recorded."""

import dataclasses
import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

LONG = 24  # a list of more messages is condensed: its numbers as one array, its texts counted
TIMINGS = frozenset({"timings_ms"})  # wall time, which is never the same
WHOLE = 64  # an array of more values is recorded by its shape, range and projections
PROJECTIONS = 4  # on fixed pseudo-random directions: a change of any value changes all of them
ABSOLUTE = 1e-12  # values are compared as equal below this: sums that cancel leave such remainders


def plain(value: Any) -> Any:
    """Return a value as JSON: dataclasses by their fields, arrays whole or, if large, condensed."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if value is None or isinstance(value, bool | int | float | str):
        return value.name if isinstance(value, Enum) else value
    if isinstance(value, np.ndarray):
        return _array(value)
    if isinstance(value, Enum | Path):
        return value.name
    if isinstance(value, BaseException):
        return f"{type(value).__name__}: {value}"
    return _container(value)


def _container(value: Any) -> Any:
    if dataclasses.is_dataclass(value):
        fields = [one.name for one in dataclasses.fields(value)]
        fields = [name for name in fields if not name.startswith("_") and name not in TIMINGS]
        return {name: plain(getattr(value, name)) for name in fields}
    if hasattr(value, "model_dump"):
        return plain(value.model_dump())
    if isinstance(value, Mapping):
        return {_key(key): plain(one) for key, one in value.items() if key not in TIMINGS}
    if isinstance(value, bytes):
        return plain(np.frombuffer(value, np.uint8))
    if isinstance(value, set | frozenset):
        return sorted((plain(one) for one in value), key=str)
    if isinstance(value, Iterable):
        values = [plain(one) for one in value]
        return values if len(values) <= LONG or _holds_arrays(values) else _condensed(values)
    raise TypeError(f"{type(value).__name__} cannot be recorded: return plain values of it")


def _key(key: Any) -> str:
    return key if isinstance(key, str) else str(plain(key))


def _holds_arrays(value: Any) -> bool:
    """Return whether a value holds condensed arrays, whose figures do not belong together."""
    if isinstance(value, dict):
        return "projections" in value or any(map(_holds_arrays, value.values()))
    return isinstance(value, list) and any(map(_holds_arrays, value))


def _condensed(values: list[Any]) -> Any:
    """Return a long list by its length, how often each text occurs, and an array for each field."""
    columns: dict[str, list[float]] = defaultdict(list)
    texts: Counter[str] = Counter()

    def visit(value: Any, field: str) -> None:
        if isinstance(value, dict):
            for name, one in value.items():
                visit(one, f"{field} {name}".lstrip())
        elif isinstance(value, list):
            for one in value:
                visit(one, field)
        elif isinstance(value, int | float):
            columns[field].append(float(value))
        else:
            texts[str(value)] += 1

    for value in values:
        visit(value, "")
    return {
        "length": len(values),
        "texts": dict(sorted(texts.items())),
        **{name or "values": _array(np.array(one)) for name, one in columns.items()},
    }


def _array(array: np.ndarray) -> Any:
    if array.size <= WHOLE or array.dtype.kind not in "fiub":
        return [plain(one) for one in array.tolist()] if array.ndim else plain(array.item())
    values = array.astype(float).ravel()
    is_finite = np.isfinite(values)
    known = np.where(is_finite, values, 0.0)
    # Digits of irrational numbers, computed without a generator whose stream may change.
    steps = np.arange(1, len(values) + 1)
    directions = [np.sin(steps * (k + math.sqrt(2))) for k in range(PROJECTIONS)]
    return {
        "shape": list(array.shape),
        "range": plain(np.array([known.min(), known.max()])),
        "finite": int(is_finite.sum()),
        "norm": float(np.linalg.norm(known)),
        "projections": [float(one @ known) for one in directions],
    }


def differences(
    got: Any, recorded: Any, relative: float, absolute: float, where: str = ""
) -> Iterator[str]:
    """Yield each place where two plain values differ.

    A number is compared to a share of the largest number of the list that holds it, so that the
    zeros of a rotation are not held to more digits than its ones.
    """
    if isinstance(got, dict) and isinstance(recorded, dict):
        if got.keys() != recorded.keys():
            yield f"{where}: keys {sorted(got)}, recorded {sorted(recorded)}"
            return
        scale = got.get("norm", 0.0) if "projections" in got else 0.0
        for key, value in got.items():
            least = max(absolute, relative * scale) if key == "projections" else absolute
            yield from differences(value, recorded[key], relative, least, f"{where}.{key}")
    elif isinstance(got, list) and isinstance(recorded, list):
        if len(got) != len(recorded):
            yield f"{where}: {len(got)} values, recorded {len(recorded)}"
            return
        least = max([absolute, *(relative * abs(one) for one in _numbers(recorded))])
        for i, (one, other) in enumerate(zip(got, recorded, strict=True)):
            yield from differences(one, other, relative, least, f"{where}[{i}]")
    elif _is_number(got) and _is_number(recorded):
        if abs(got - recorded) > max(absolute, relative * abs(recorded)):
            yield f"{where}: {got!r}, recorded {recorded!r}"
    elif got != recorded:
        yield f"{where}: {got!r}, recorded {recorded!r}"


def _is_number(value: Any) -> bool:
    """Return whether a value is a float; whole numbers are counts, which are compared exactly."""
    return isinstance(value, float)


def _numbers(values: list[Any]) -> Iterator[float]:
    """Yield the numbers of a list and of the lists in it, such as the rows of a matrix."""
    for value in values:
        if _is_number(value):
            yield value
        elif isinstance(value, list):
            yield from _numbers(value)
