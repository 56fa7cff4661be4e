"""Values of ports and states of plugins as JSON and arrays, and back, bit for bit.

Known are numbers, texts, lists, tuples, sets, mappings, arrays, enums, and dataclasses. A class is
found among those that are imported: reading a value imports and runs nothing.
"""

import sys
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

from executive.errors import DataError

_NUMBERS = "biufc"  # kinds of arrays that are kept: truth, integers, floats, complex
_MARK = "$"
# In the metadata of a field that holds wall times and has a default: it is not kept, so that equal
# runs leave equal bytes.
WALL_TIME = "wall_time"


class NotKeptError(DataError):
    """A value of a kind that cannot be kept."""


def encode(value: Any, arrays: list[np.ndarray]) -> Any:
    """Return a value as JSON holds it, with its arrays beside.

    Args:
        value: The value.
        arrays: Where the value's arrays are appended.

    Raises:
        NotKeptError: If a part of it is of another kind; it names the class.
    """
    if value is None or type(value) in (bool, int, float, str):
        return value
    if isinstance(value, Enum):
        return {_MARK: "enum", "class": _name(type(value)), "value": encode(value.value, arrays)}
    if isinstance(value, np.generic | np.ndarray):
        return _array(value, arrays)
    if isinstance(value, list):
        return [encode(one, arrays) for one in value]
    if isinstance(value, tuple) and type(value) is tuple:
        return {_MARK: "tuple", "items": [encode(one, arrays) for one in value]}
    if isinstance(value, set | frozenset):
        items = sorted((encode(one, arrays) for one in value), key=repr)
        return {_MARK: type(value).__name__, "items": items}
    if isinstance(value, Mapping):
        items = [[encode(key, arrays), encode(one, arrays)] for key, one in value.items()]
        return {_MARK: "mapping", "items": items}
    if is_dataclass(value):
        kept = {
            f.name: encode(getattr(value, f.name), arrays)
            for f in fields(value)
            if f.init and not f.metadata.get(WALL_TIME)
        }
        return {_MARK: "class", "class": _name(type(value)), "fields": kept}
    raise NotKeptError(f"a value of class {_name(type(value))} cannot be kept")


def decode(found: Any, arrays: list[np.ndarray]) -> Any:
    """Return the value that `encode` was given.

    Raises:
        DataError: If it is none, or names a class that no module defines.
    """
    if isinstance(found, list):
        return [decode(one, arrays) for one in found]
    if not isinstance(found, dict):
        return found
    try:
        return _marked(found, arrays)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise DataError(f"not a kept value: {error}") from error


def _marked(found: dict[str, Any], arrays: list[np.ndarray]) -> Any:
    match found[_MARK]:
        case "array":
            return arrays[found["number"]]
        case "number":
            return arrays[found["number"]][()]
        case "tuple":
            return tuple(decode(one, arrays) for one in found["items"])
        case "set" | "frozenset" as kind:
            items = (decode(one, arrays) for one in found["items"])
            return set(items) if kind == "set" else frozenset(items)
        case "mapping":
            return {decode(key, arrays): decode(one, arrays) for key, one in found["items"]}
        case "enum":
            return _class(found["class"], Enum)(decode(found["value"], arrays))
        case "class":
            kept = {name: decode(one, arrays) for name, one in found["fields"].items()}
            return _class(found["class"], object)(**kept)
    raise DataError(f"not a kept value: unknown mark '{found[_MARK]}'")


def _array(value: Any, arrays: list[np.ndarray]) -> dict[str, Any]:
    if value.dtype.kind not in _NUMBERS:
        raise NotKeptError(f"an array of {value.dtype} cannot be kept")
    arrays.append(np.asarray(value))
    kind = "array" if isinstance(value, np.ndarray) else "number"
    return {_MARK: kind, "number": len(arrays) - 1}


def _name(kind: type) -> str:
    return f"{kind.__module__}:{kind.__qualname__}"


def _class(name: str, base: type) -> Any:
    module, _, path = name.partition(":")
    found: Any = sys.modules.get(module)
    for part in path.split("."):
        found = getattr(found, part, None)
    is_kept = isinstance(found, type) and (is_dataclass(found) or issubclass(found, Enum))
    if not is_kept or not issubclass(found, base):
        raise DataError(f"the class {name} of a kept value is not known here")
    return found
