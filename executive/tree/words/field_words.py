"""A settings field in words: its type, unit, default and bounds."""

import inspect
import types
import typing
from collections.abc import Mapping
from enum import Enum
from typing import Any

from pydantic.fields import FieldInfo

from executive.arrays import Float
from executive.config import UNITS, dimension_of, marks_of
from executive.events.event import plain

_NAMES = {object: "any", float: "number", int: "whole number", str: "text", bool: "true or false"}
_SIGNS = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤"}


def type_words(kind: Any) -> str:
    """Return a type for people: `number`, `list of text`, the values of a choice."""
    origin, given = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Annotated:
        return type_words(given[0])
    if origin is typing.Literal:
        return " or ".join(f"`{one}`" for one in given)
    if origin in (typing.Union, types.UnionType):
        return " or ".join(type_words(one) for one in given if one is not type(None))
    if origin in (tuple, list):
        if origin is list or given[-1] is Ellipsis:
            return f"list of {type_words(given[0])}"
        return f"[{', '.join(type_words(one) for one in given)}]"
    if origin in (dict, Mapping):
        return f"{type_words(given[0])} → {type_words(given[1])}"
    if kind == Float:
        return "numbers"
    if inspect.isclass(kind) and issubclass(kind, Enum):
        return " or ".join(f"`{one.value}`" for one in kind)
    return _NAMES.get(kind) or kind.__name__.lower()


def dimension_words(info: FieldInfo) -> tuple[str, str]:
    """Return a field's dimension and the unit of a plain number; empty if it is no quantity."""
    dimension = dimension_of(info)
    return (dimension, next(iter(UNITS[dimension]))) if dimension else ("", "")


def default_words(info: FieldInfo) -> str:
    """Return a field's default as text; `required` where there is none, empty for None."""
    if info.is_required():
        return "required"
    value = info.get_default(call_default_factory=True)
    return "" if value is None else f"{plain(value) if isinstance(value, tuple | Enum) else value}"


def bounds_words(info: FieldInfo) -> str:
    """Return a field's limits; empty if it has none."""
    found = []
    for constraint in marks_of(info):
        for key, sign in _SIGNS.items():
            if getattr(constraint, key, None) is not None:
                found.append(f"{sign} {getattr(constraint, key):.4g}")
        if getattr(constraint, "min_length", None):
            found.append(f"at least {constraint.min_length}")
    return ", ".join(found)
