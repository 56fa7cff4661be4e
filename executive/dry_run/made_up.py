"""Values that are made up by their type: what a mocked leaf gives where no file says what.

A number is drawn by its dimension, an array by the shape that its docstring states. An object is a
stand-in: an instance of its class whose fields and properties are made up when they are read, so
that a field of the mock's file may be given and the others follow. What is read is told.
"""

import math
import re
import typing
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from executive.errors import ConfigError
from executive.leaf.port import section
from executive.tree.expressions.dimension import NAMED, PLAIN, Dimension
from executive.tree.expressions.kinds import bare, dimension_of, fields_of, members, sort_of

_MOST = 3  # items of a list, from none
_SHAPE = re.compile(r"(?:shape|each) \(([^)]*)\)")
# Bounds of the numbers that are drawn, in SI units: those of stones, of their places and of moves.
_BOUNDS: tuple[tuple[Dimension, float, float], ...] = (
    (NAMED["length"], 0.0, 5.0),
    (NAMED["mass"], 100.0, 2000.0),
    (NAMED["angle"], -math.pi, math.pi),
    (NAMED["time"], 0.0, 60.0),
    (NAMED["volume"], 0.05, 1.0),
)

Tell = Callable[[str, Any], None]  # what was read, and its value
Recipe = Callable[["Maker"], Any]  # makes a value that a file gives in part


class Maker:
    """Makes up values; equal generators give equal values."""

    def __init__(self, rng: np.random.Generator, tell: Tell) -> None:
        """Take chance, and whom to tell which made-up field of an object was read."""
        self._rng = rng
        self._tell = tell

    def make(self, kind: Any, name: str, doc: str = "") -> Any:
        """Return a value of a type.

        Args:
            kind: The type, as ports and fields have them.
            name: What the value is called.
            doc: Its documentation, which states the shape of an array.

        Raises:
            ConfigError: If no value of the type can be made up.
        """
        kind = members(kind)[0]
        inner = bare(kind)
        match sort_of(kind):
            case "truth":
                return bool(self._rng.random() < 0.5)
            case "choice":
                return self._one_of(tuple(inner))
            case "number":
                return self._number(kind, inner)
            case "text":
                literal = typing.get_origin(inner) is typing.Literal
                return self._one_of(typing.get_args(inner)) if literal else "made up"
            case "array":
                return self._array(name, doc)
            case "list":
                return self._items(inner, name, doc)
            case "mapping":
                return {}
            case "missing":
                return None
            case "object":
                return self.stand_in(typing.get_origin(inner) or inner, name, {})
        return "made up"

    def stand_in(self, cls: type, name: str, given: Mapping[str, Recipe]) -> Any:
        """Return an instance of a class whose fields are given or made up when they are read.

        Raises:
            ConfigError: If its class lets no other class derive from it.
        """
        try:
            made: Any = object.__new__(_stand_in_class(cls))
        except TypeError as error:
            told = f"no {cls.__name__} can be made up for '{name}': {error}"
            raise ConfigError(f"{told}; leave its leaf out, or declare a dataclass") from error
        values = {field: recipe(self) for field, recipe in given.items()}
        object.__setattr__(made, "_made", _Fields(cls, name, values, self))
        return made

    def read(self, cls: type, of: str, field: str) -> Any:
        """Make up a field of an object that is read, and tell it."""
        what = f"{of}.{field}"
        value = self.make(fields_of(cls)[field], what, _doc(cls, field))
        self._tell(what, value)
        return value

    def _one_of(self, many: tuple[Any, ...]) -> Any:
        return many[int(self._rng.integers(len(many)))]

    def _number(self, kind: Any, inner: Any) -> Any:
        if typing.get_origin(inner) is typing.Literal:
            return self._one_of(typing.get_args(inner))
        if issubclass(inner, int | np.integer):
            return int(self._rng.integers(6))
        dimension = dimension_of(kind) or PLAIN
        low, high = next(((a, b) for one, a, b in _BOUNDS if one == dimension), (0.0, 1.0))
        return float(self._rng.uniform(low, high))

    def _array(self, name: str, doc: str) -> np.ndarray:
        stated = _SHAPE.search(doc)
        if stated is None:
            raise ConfigError(
                f"'{name}' cannot be made up: its docstring states no shape, such as 'shape (3,)'; "
                "give it in the file of --mocks"
            )
        sizes = [one.strip() for one in stated[1].split(",") if one.strip()]
        shape = tuple(int(one) if one.isdecimal() else _MOST + 1 for one in sizes)
        if shape == (4, 4):  # a pose
            pose = np.eye(4)
            pose[:3, 3] = self._rng.uniform(-5.0, 5.0, 3)
            return pose
        return self._rng.uniform(-5.0, 5.0, shape)

    def _items(self, inner: Any, name: str, doc: str) -> Any:
        origin, arguments = typing.get_origin(inner) or inner, typing.get_args(inner)
        if origin is tuple and arguments and arguments[-1] is not Ellipsis:
            return tuple(self.make(one, name, doc) for one in arguments)
        item = arguments[0] if arguments else object
        count = int(self._rng.integers(_MOST + 1))
        made = [self.make(item, f"{name}[{number}]", doc) for number in range(count)]
        return origin(made) if origin in (tuple, set, frozenset) else made


class _Fields:
    """The fields of a stand-in, each made up once."""

    def __init__(self, cls: type, name: str, values: dict[str, Any], maker: Maker) -> None:
        self._cls, self._name, self._values, self._maker = cls, name, values, maker

    def __call__(self, field: str) -> Any:
        if field not in self._values:
            self._values[field] = self._maker.read(self._cls, self._name, field)
        return self._values[field]


@lru_cache(maxsize=256)
def _stand_in_class(cls: type) -> type:
    fields = frozenset(fields_of(cls))

    def read(self: Any, name: str) -> Any:
        if name in fields:
            return object.__getattribute__(self, "_made")(name)
        return object.__getattribute__(self, name)

    members = {
        "__slots__": ("_made",),
        "__doc__": cls.__doc__,
        "__module__": cls.__module__,
        "__getattribute__": read,
        "__repr__": lambda _: f"{cls.__name__} (made up)",
        "__eq__": lambda one, other: one is other,
        "__hash__": lambda one: id(one),
    }
    return type(cls.__name__, (cls,), members)


def _doc(cls: type, field: str) -> str:
    documented = section(cls.__doc__, "Attributes").get(field)
    if documented is not None:
        return documented
    found = getattr(cls, field, None)
    return (found.fget.__doc__ or "") if isinstance(found, property) and found.fget else ""
