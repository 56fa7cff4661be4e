"""Types of values in expressions: their sort, their fields, their dimension.

A type is a Python annotation, as ports and fields have them. `Annotated[float, Dimension]` is a
number whose dimension is known; a plain `float` may have any, a plain `int` is a count.
"""

import re
import types
import typing
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from functools import cache, lru_cache
from typing import Any

import numpy as np

from executive.config import UNITS, Quantity
from executive.leaf.port import section
from executive.tree.expressions.dimension import NAMED, PLAIN, Dimension, unit_dimension
from executive.tree.expressions.parser import UNIT_NAMES

_UNIT_IN_DOC = re.compile(r"\[([^\]\s]+)\]")
# Endings of names that carry a unit; longer ones first.
_ENDINGS = (
    ("_rad_s", NAMED["angular speed"]),
    ("_kg_m3", NAMED["density"]),
    ("_m_s", NAMED["speed"]),
    ("_rad", NAMED["angle"]),
    ("_kg", NAMED["mass"]),
    ("_hz", NAMED["frequency"]),
    ("_m3", NAMED["volume"]),
    ("_m2", Dimension((2, 0, 0, 0, 0))),
    ("_m", NAMED["length"]),
    ("_s", NAMED["time"]),
    ("_n", NAMED["force"]),
)


@cache
def number(dimension: Dimension | None, kind: type = float) -> Any:
    """Return the type of a number; None is a dimension that is not known."""
    return kind if dimension is None else typing.Annotated[kind, dimension]


COUNT = number(PLAIN, int)
_WRITTEN = "written in the expression"


@cache
def written(kind: type) -> Any:
    """Return the type of a number without a unit that stands in the expression: it is SI."""
    return typing.Annotated[kind, PLAIN, _WRITTEN]


def is_written(kind: Any) -> bool:
    """Return whether a number without a unit stands in the expression itself."""
    return _WRITTEN in getattr(kind, "__metadata__", ())


def clash(one: Any, other: Any) -> str:
    """Return why two numbers cannot be compared or added, with the cure; empty if they can.

    A number without a unit is SI where it is written: `{stone.reach} < 2`. A whole number that a
    key holds, or a function gives, is a count or an identity, and stands beside no quantity.
    """
    have, against = dimension_of(one), dimension_of(other)
    if have is None or against is None:
        return ""
    if not have.suits(against):
        return "both sides need units of one dimension"
    for plain, dimension in ((one, against), (other, have)):
        if _is_count(plain) and not dimension.is_plain and any(dimension.exponents):
            unit = next(
                (u for u, factor in UNITS.get(str(dimension), {}).items() if factor == 1), ""
            )
            example = f": multiply it, as in '{{count}} * 1 {unit}'" if unit else ""
            return f"a whole number that a key holds has no unit{example}"
    return ""


def _is_count(kind: Any) -> bool:
    return dimension_of(kind) == PLAIN and not is_written(kind)


@dataclass(frozen=True, slots=True)
class Known:
    """Marks a type whose only value is written in a file.

    Attributes:
        value: The value.
        given: Which call gives it to a tree, and where, for messages; empty within a tree.
    """

    value: Any
    given: str = field(default="", compare=False)


def known_value(kind: Any) -> Known | None:
    """Return the value of a type that has only one, written in the file."""
    notes = getattr(kind, "__metadata__", ())  # of typing.Annotated
    return next((note for note in notes if isinstance(note, Known)), None)


def bare(kind: Any) -> Any:
    """Return a type without its dimension and without the name that `NewType` gives it."""
    while True:
        if type(kind) is type:  # fast path: most types are plain classes
            return kind
        if hasattr(kind, "__metadata__"):  # typing.Annotated
            kind = kind.__origin__
        elif hasattr(kind, "__supertype__"):
            kind = kind.__supertype__
        else:
            return kind


def dimension_of(kind: Any) -> Dimension | None:
    """Return a number's dimension, None if it is not known."""
    if hasattr(kind, "__metadata__"):  # typing.Annotated
        for note in kind.__metadata__:
            if isinstance(note, Dimension):
                return note
            if isinstance(note, Quantity):
                return NAMED[note.dimension]
        return dimension_of(kind.__origin__)
    return PLAIN if bare(kind) is int else None


def members(kind: Any) -> tuple[Any, ...]:
    """Return the alternatives of a union, or the type itself."""
    inner = bare(kind)
    if type(inner) is type:
        return (kind,)
    if typing.get_origin(inner) in (typing.Union, types.UnionType):
        return tuple(one for part in typing.get_args(inner) for one in members(part))
    return (kind,)


def sort_of(kind: Any) -> str:
    """Return a type's sort: unknown, missing, truth, number, text, choice, list, array, mapping or
    object.
    """
    return _sort(bare(kind))


@lru_cache(maxsize=4096)
def _sort(inner: Any) -> str:
    if typing.get_origin(inner) is typing.Literal:
        inner = type(typing.get_args(inner)[0])
    found = typing.get_origin(inner) or inner
    if found in (Any, object) or not isinstance(found, type):
        return "unknown"
    for sort, classes in _SORTS:
        if issubclass(found, classes):
            return sort
    return "object"


_SORTS: tuple[tuple[str, Any], ...] = (
    ("missing", type(None)),
    ("truth", (bool, np.bool_)),
    ("choice", Enum),
    ("number", (int, float, np.number)),
    ("text", str),
    ("array", np.ndarray),
    ("mapping", Mapping),
    ("list", (Sequence, Collection)),
)


def item_of(kind: Any) -> Any:
    """Return the type of the items of a list, tuple or array, or of the values of a mapping."""
    inner = bare(kind)
    if sort_of(kind) == "array":
        return number(dimension_of(kind))
    arguments = [one for one in typing.get_args(inner) if one is not Ellipsis]
    if not arguments:
        return Any
    return arguments[-1] if sort_of(kind) == "mapping" else typing.Union[tuple(arguments)]  # noqa: UP007


@lru_cache(maxsize=512)
def fields_of(cls: type) -> Mapping[str, Any]:
    """Return the types of the public fields and properties of a class, with their dimensions.

    The dimension is that of the annotation (`Meters`), of the name's ending (`reach_m`), or of the
    unit in the docstring (`Distance to the centroid [m].`).
    """
    docs = section(cls.__doc__, "Attributes")
    hints = _hints(cls)
    found = {name: kind for name, kind in hints.items() if not name.startswith("_")}
    for name, value in _class_members(cls).items():
        if isinstance(value, property) and value.fget and not name.startswith("_"):
            found[name] = _hints(value.fget).get("return", Any)
            docs.setdefault(name, (value.fget.__doc__ or "").partition("\n")[0])
    return {name: measured(kind, name, docs.get(name, "")) for name, kind in found.items()}


def field_name(cls: type, name: str) -> str:
    """Return the field that a name means: `mass` is `mass_kg` where no field is called `mass`.

    Expressions compare quantities with units, so that the unit in the name may be left out.
    """
    known = fields_of(cls)
    if name in known:
        return name
    return next((name + ending for ending, _ in _ENDINGS if name + ending in known), name)


def measured(kind: Any, name: str, doc: str) -> Any:
    """Return the type of a number with the dimension that its name or its documentation tells."""
    alternatives = tuple(
        number_or_array(one, name, doc) if sort_of(one) in ("number", "array") else one
        for one in members(kind)
    )
    return typing.Union[alternatives] if len(alternatives) > 1 else alternatives[0]  # noqa: UP007


def number_or_array(kind: Any, name: str, doc: str) -> Any:
    """Return a number's or an array's type with the dimension that is told."""
    if typing.get_origin(kind) is typing.Annotated and dimension_of(kind) is not None:
        return kind
    told = next((dimension for ending, dimension in _ENDINGS if name.endswith(ending)), None)
    unit = next((unit for unit in _UNIT_IN_DOC.findall(doc) if unit in UNIT_NAMES), None)
    if told is None and unit is not None and not name.endswith("_ms"):
        told = unit_dimension(unit)
    return kind if told is None else typing.Annotated[kind, told]


def _hints(of: Any) -> dict[str, Any]:
    try:
        return typing.get_type_hints(of, include_extras=True)
    except (NameError, TypeError):  # an annotation that cannot be resolved here
        return dict.fromkeys(getattr(of, "__annotations__", {}), Any)


def _class_members(cls: type) -> dict[str, Any]:
    return {name: value for base in reversed(cls.__mro__) for name, value in vars(base).items()}
