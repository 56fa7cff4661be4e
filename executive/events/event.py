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
from typing import Any, ClassVar, TypeVar, cast

import numpy as np

from executive.errors import ConfigError, DataError

_KINDS: dict[str, type["Event"]] = {}
_MOST_SHOWN = 80  # characters of a refused value in a message
_T = TypeVar("_T")


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
    return read_record(_KINDS[kind], payload, f"event '{kind}'")


def read_record(kind: type[_T], payload: object, where: str) -> _T:
    """Return the frozen dataclass that `plain` has turned into what JSON holds.

    Args:
        kind: The class.
        payload: What JSON holds.
        where: What a message calls it, such as `event 'stone_grasped'`.

    Raises:
        DataError: If fields are missing, too many, or of the wrong form; the message names the
            field with the path to it.
    """
    return cast(_T, _read_class(kind, payload, where))


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
        raise _refused(where, "a mapping", payload)
    known = {one.name: one for one in fields(kind)}
    for name in payload:
        if name not in known:
            raise DataError(f"{where} has no field '{name}'")
    for name, one in known.items():
        if name not in payload and one.default is MISSING and one.default_factory is MISSING:
            raise DataError(f"{where} lacks its field '{name}'")
    hints = _hints(kind)
    return kind(**{n: _read(hints[n], v, f"{where}, field '{n}'") for n, v in payload.items()})


def _refused(where: str, expected: str, value: object) -> DataError:
    text = repr(value)
    shown = text if len(text) <= _MOST_SHOWN else f"{text[:_MOST_SHOWN]} …"
    return DataError(f"{where}: expected {expected}, got {shown}")


def _read(wanted: Any, value: Any, where: str) -> Any:
    """Turn what JSON holds back into a value of a type."""
    origin, arguments = typing.get_origin(wanted), typing.get_args(wanted)
    if origin in (typing.Union, types.UnionType):
        if value is None and type(None) in arguments:
            return None
        return _read_one_of([one for one in arguments if one is not type(None)], value, where)
    if origin is np.ndarray or wanted is np.ndarray:
        return _array(value, where)
    if origin is tuple:
        return _tuple(arguments, value, where)
    if origin is typing.Literal:
        return _one_of(arguments, value, where)
    if origin is not None and issubclass(origin, Mapping):
        return _mapping(arguments[1], value, where)
    if isinstance(wanted, type) and issubclass(wanted, Enum):
        return wanted(_one_of([one.value for one in wanted], value, where))
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


def _array(value: Any, where: str) -> Any:
    if isinstance(value, list | int | float):
        try:
            return np.asarray(value, dtype=float)
        except (ValueError, TypeError):  # rows of different lengths, or something else than numbers
            pass
    raise _refused(where, "an array of numbers", value)


def _tuple(kinds: Sequence[Any], value: Any, where: str) -> tuple[Any, ...]:
    if not isinstance(value, list | tuple):
        raise _refused(where, "a list", value)
    if kinds[-1] is Ellipsis:
        kinds = [kinds[0]] * len(value)
    if len(kinds) != len(value):
        raise _refused(where, f"a list of {len(kinds)}", value)
    pairs = enumerate(zip(kinds, value, strict=True))
    return tuple(_read(kind, one, f"{where}[{number}]") for number, (kind, one) in pairs)


def _one_of(allowed: Sequence[Any], value: Any, where: str) -> Any:
    if value not in allowed:
        raise _refused(where, f"one of {', '.join(map(str, allowed))}", value)
    return value


def _mapping(kind: Any, value: Any, where: str) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise _refused(where, "a mapping", value)
    return {key: _read(kind, one, f"{where}, '{key}'") for key, one in value.items()}


def _scalar(wanted: Any, value: Any, where: str) -> Any:
    if not isinstance(wanted, type) or wanted in (object, Any):
        return value
    accepted = (int, float) if wanted is float else (wanted,)
    is_truth = isinstance(value, bool) and wanted is not bool
    if is_truth or not isinstance(value, accepted):
        raise _refused(where, wanted.__name__, value)
    return value
