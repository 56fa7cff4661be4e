"""Compatibility of port types, given as classes or as names in a mission file."""

import re
import types
import typing
from collections.abc import Iterable
from typing import Any

from executive.tree.expressions.dimension import NAMED, PLAIN
from executive.tree.expressions.kinds import bare, dimension_of, sort_of

_LIST_NAME = re.compile(r"list\[(\w+)\]")
_TYPE_NAME = re.compile(r"\w+\??|list\[\w+\]\??")


def is_type_name(text: str) -> bool:
    """Return whether a text is a port type: `Stone`, `list[Stone]`, each with `?` if optional."""
    return _TYPE_NAME.fullmatch(text) is not None


def type_name(wanted: Any) -> str:
    """Return a type as a mission file writes it."""
    if dimension_of(wanted) not in (None, PLAIN):
        return str(dimension_of(wanted))
    wanted = bare(wanted)
    if is_unknown(wanted):
        return "object"
    if typing.get_origin(wanted) is None and isinstance(wanted, type):
        return wanted.__name__
    if typing.get_origin(wanted) is list:
        return f"list[{type_name(typing.get_args(wanted)[0])}]"
    return str(wanted)


def is_unknown(kind: Any) -> bool:
    """Return whether a type is not known before the run."""
    return kind is Any or kind is object


def fits(have: Any, wanted: Any) -> bool:
    """Whether a value of one type can be read as another; what is not known fits."""
    have_dimension, dimension = dimension_of(have), dimension_of(wanted)
    have, wanted = bare(have), bare(wanted)
    if is_unknown(have) or is_unknown(wanted):
        return True
    if _is_union(have):
        return any(fits(one, wanted) for one in typing.get_args(have))
    if _is_union(wanted):
        return any(fits(have, one) for one in typing.get_args(wanted))
    have_class, wanted_class = typing.get_origin(have) or have, typing.get_origin(wanted) or wanted
    if not isinstance(have_class, type) or not isinstance(wanted_class, type):
        return True
    if wanted_class is float and have_class in (int, float):
        return have_dimension is None or dimension is None or have_dimension.suits(dimension)
    if have_class is bool and wanted_class in (int, float):
        return False
    if not issubclass(have_class, wanted_class):
        return False
    pairs = zip(typing.get_args(have), typing.get_args(wanted), strict=False)
    return all(fits(one, other) for one, other in pairs) if have_class is list else True


def fits_name(have: Any, name: str) -> bool:
    """Whether a value of a type suits a type's name, such as `Stone` or `list[Stone]`."""
    if is_unknown(bare(have)) or name == "object":
        return True
    named = NAMED.get(name.replace("_", " "))
    if named is not None:
        dimension = dimension_of(have)
        return sort_of(have) == "number" and (dimension is None or dimension.suits(named))
    have = bare(have)
    if _is_union(have):
        return any(fits_name(one, name) for one in typing.get_args(have))
    inner = _LIST_NAME.fullmatch(name)
    if inner:
        arguments = typing.get_args(have)
        return (typing.get_origin(have) or have) is list and (
            not arguments or fits_name(arguments[0], inner.group(1))
        )
    have_class = typing.get_origin(have) or have
    if name == "float" and have_class is int:
        return True
    return not isinstance(have_class, type) or name in {one.__name__ for one in have_class.__mro__}


def holds(value: Any, wanted: Any) -> bool:
    """Whether a value is of a port's type; the items of a list are looked at as well."""
    wanted = bare(wanted)
    if is_unknown(wanted):
        return True
    if _is_union(wanted):
        return any(holds(value, one) for one in typing.get_args(wanted))
    origin = typing.get_origin(wanted) or wanted
    if not isinstance(origin, type):
        return True
    if origin is list:
        inner = (typing.get_args(wanted) or (Any,))[0]
        return isinstance(value, list) and all(holds(item, inner) for item in value)
    if isinstance(value, bool) and origin is not bool:
        return issubclass(bool, origin) and origin not in (int, float)
    return isinstance(value, int | float) if origin is float else isinstance(value, origin)


def type_of(value: Any) -> Any:
    """Return the type of a literal."""
    if isinstance(value, list):
        kinds = {type_of(item) for item in value}
        return list[kinds.pop()] if len(kinds) == 1 else list  # type: ignore[misc]
    return type(value)


def item_type(have: Any) -> Any:
    """Return the type of a list's items, or None for what is no list."""
    have = bare(have)
    if is_unknown(have):
        return Any
    if (typing.get_origin(have) or have) is not list:
        return None
    return (typing.get_args(have) or (Any,))[0]


def names(kinds: Iterable[Any]) -> str:
    """Return types for an error's sentence."""
    return " or ".join(sorted(type_name(kind) for kind in kinds))


def _is_union(kind: Any) -> bool:
    return typing.get_origin(kind) in (typing.Union, types.UnionType)
