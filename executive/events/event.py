"""What all events have in common: a kind, and fields that go to JSON and come back.

An event is a frozen dataclass whose fields are numbers, texts, truth values, enumerations, arrays
(`Float`), other dataclasses, and tuples or mappings of these. A package may bring events of its
own: subclasses are registered by their kind.
"""

import re
import types
import typing
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, ClassVar

import numpy as np

from executive.errors import ConfigError, DataError

_KINDS: dict[str, type["Event"]] = {}


@dataclass(frozen=True, slots=True, eq=False)
class Event:
    """Something that happened in a mission.

    Attributes:
        kind: Name of the event in the journal: `stone_grasped` for the class `StoneGrasped`.
    """

    kind: ClassVar[str] = ""

    def __init_subclass__(cls) -> None:
        cls.kind = re.sub(r"(?<!^)(?=[A-Z])", "_", cls.__name__).lower()
        known = _KINDS.get(cls.kind)
        if known is not None and known.__module__ != cls.__module__:
            raise ConfigError(
                f"{known.__module__} and {cls.__module__} both define the event '{cls.kind}'"
            )
        _KINDS[cls.kind] = cls

    def payload(self) -> dict[str, object]:
        """Return the fields as JSON holds them."""
        return {one.name: plain(getattr(self, one.name)) for one in fields(self)}


@dataclass(frozen=True, slots=True, eq=False)
class UnknownEvent(Event):
    """An event of a package that is not imported, as it stands in the journal.

    Attributes:
        name: Its kind.
        values: Its fields.
    """

    name: str
    values: Mapping[str, object]

    def payload(self) -> dict[str, object]:
        return dict(self.values)


def event_classes() -> Mapping[str, type[Event]]:
    """Return the classes of the events of this and of every imported package, by class name."""
    return {one.__name__: one for one in _KINDS.values() if one is not UnknownEvent}


def known_kinds() -> Sequence[str]:
    """Return the kinds of all events whose modules are imported."""
    return tuple(_KINDS)


def event_from(kind: str, payload: Mapping[str, object]) -> Event:
    """Return the event that a line of a journal holds; of an unknown kind, an `UnknownEvent`.

    Raises:
        DataError: If fields are missing, too many, or of the wrong form.
    """
    if kind not in _KINDS:
        return UnknownEvent(kind, payload)
    return _read_class(_KINDS[kind], payload, f"event '{kind}'")  # type: ignore[no-any-return]


def plain(value: object) -> object:
    """Turn a value into what JSON holds: numbers, strings, lists, mappings."""
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {one.name: plain(getattr(value, one.name)) for one in fields(value)}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    return str(value)


@cache
def _hints(kind: type) -> Mapping[str, Any]:
    return typing.get_type_hints(kind)


def _read_class(kind: type, payload: Any, where: str) -> Any:
    if not isinstance(payload, Mapping):
        raise DataError(f"{where}: expected a mapping, got {payload!r}")
    known = {one.name: one for one in fields(kind)}
    for name in payload:
        if name not in known:
            raise DataError(f"{where} has no field '{name}'")
    for name, one in known.items():
        if name not in payload and one.default is MISSING and one.default_factory is MISSING:
            raise DataError(f"{where} lacks its field '{name}'")
    hints = _hints(kind)
    return kind(**{n: _read(hints[n], v, f"{where}, field '{n}'") for n, v in payload.items()})


def _read(wanted: Any, value: Any, where: str) -> Any:
    """Turn what JSON holds back into a value of a type."""
    origin, arguments = typing.get_origin(wanted), typing.get_args(wanted)
    if origin in (typing.Union, types.UnionType):
        inner = [one for one in arguments if one is not type(None)]
        return None if value is None else _read_one_of(inner, value, where)
    if origin is np.ndarray or wanted is np.ndarray:
        return np.asarray(value, dtype=float)
    if origin is tuple:
        kinds = [arguments[0]] * len(value) if arguments[-1] is Ellipsis else arguments
        return tuple(_read(k, v, where) for k, v in zip(kinds, value, strict=True))
    if origin is typing.Literal:
        if value not in arguments:
            raise DataError(
                f"{where}: expected one of {', '.join(map(str, arguments))}, got {value!r}"
            )
        return value
    if origin is not None and issubclass(origin, Mapping):
        return {key: _read(arguments[1], one, where) for key, one in value.items()}
    if isinstance(wanted, type) and issubclass(wanted, Enum):
        return wanted(value)
    if is_dataclass(wanted) and isinstance(wanted, type):
        return _read_class(wanted, value, where)
    return _scalar(wanted, value, where)


def _read_one_of(kinds: Sequence[Any], value: Any, where: str) -> Any:
    """Read a value of the first type that takes it."""
    for kind in kinds[:-1]:
        try:
            return _read(kind, value, where)
        except DataError:
            continue
    return _read(kinds[-1], value, where)


def _scalar(wanted: Any, value: Any, where: str) -> Any:
    if not isinstance(wanted, type) or wanted in (object, Any):
        return value
    accepted = (int, float) if wanted is float else (wanted,)
    is_truth = isinstance(value, bool) and wanted is not bool
    if is_truth or not isinstance(value, accepted):
        raise DataError(f"{where}: expected {wanted.__name__}, got {value!r}")
    return value
