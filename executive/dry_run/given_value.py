"""Values that a file gives to the outputs of a mocked leaf, read by the type of the port."""

import typing
from collections.abc import Callable, Sequence
from copy import deepcopy
from typing import Any

import numpy as np

from executive.config import parse_quantity
from executive.dry_run.made_up import Recipe
from executive.errors import did_you_mean
from executive.tree.expressions.dimension import NAMED, PLAIN, Dimension
from executive.tree.expressions.kinds import (
    bare,
    dimension_of,
    field_name,
    fields_of,
    members,
    sort_of,
)
from executive.tree.port_types import type_name
from executive.tree.reading import Reading
from executive.tree.value import Listing, Scalar, Table, Value, describe, plain

_DIMENSIONS = {dimension: name for name, dimension in NAMED.items()}


def read_given(value: Value, kind: Any, what: str, reading: Reading) -> Recipe | None:
    """Return what makes the value that a file gives; None after a mistake was noted.

    Args:
        value: What the file says.
        kind: Type of the port or field.
        what: What the value is for, in messages.
        reading: Where mistakes are noted.
    """
    kind = _chosen(value, kind)
    match sort_of(kind):
        case "object":
            return _object(value, kind, what, reading)
        case "list":
            return _items(value, kind, what, reading)
        case "array":
            return _array(value, kind, what, reading)
        case "number" if typing.get_origin(bare(kind)) is typing.Literal:
            allowed = {str(one): one for one in typing.get_args(bare(kind))}
            return _one_of(value, str(plain(value)), allowed, what, reading)
        case "number":
            return _constant(_number(value, kind, what, reading))
        case "truth":
            return _constant(reading.truth(value, what))
        case "text":
            return _text(value, kind, what, reading)
        case "choice":
            return _choice(value, kind, what, reading)
    found = plain(value)
    return lambda maker: deepcopy(found)


def _chosen(value: Value, kind: Any) -> Any:
    """Return the alternative of a union that a value may be: nothing, or the first other."""
    alternatives = members(kind)
    is_nothing = isinstance(value, Scalar) and value.value is None
    missing = [one for one in alternatives if sort_of(one) == "missing"]
    others = [one for one in alternatives if sort_of(one) != "missing"]
    return Any if is_nothing and missing else others[0]


def _constant(found: Any) -> Recipe | None:
    return None if found is None else lambda maker: found


def _number(value: Value, kind: Any, what: str, reading: Reading) -> int | float | None:
    got = value.value if isinstance(value, Scalar) else None
    dimension, is_whole = dimension_of(kind), issubclass(bare(kind), int | np.integer)
    if isinstance(got, str) and dimension in _DIMENSIONS:
        try:
            return parse_quantity(got, _DIMENSIONS[dimension])
        except ValueError as error:
            reading.fail(value, f"{what}: {error}")
            return None
    is_number = isinstance(got, int | float) and not isinstance(got, bool)
    if not is_number or (is_whole and not isinstance(got, int)):
        wanted = "a whole number" if is_whole else _number_words(dimension)
        reading.fail(value, f"{what} is {wanted}, not {describe(value)}")
        return None
    return got  # type: ignore[return-value]  # it is a number


def _number_words(dimension: Dimension | None) -> str:
    if dimension is None or dimension == PLAIN:
        return "a number"
    return f"a number or a quantity ({dimension})"


def _text(value: Value, kind: Any, what: str, reading: Reading) -> Recipe | None:
    text = reading.text(value, what)
    allowed = typing.get_args(bare(kind)) if typing.get_origin(bare(kind)) else ()
    if text is None:
        return None
    return _one_of(value, text, {str(one): one for one in allowed} or {text: text}, what, reading)


def _choice(value: Value, kind: Any, what: str, reading: Reading) -> Recipe | None:
    text = reading.text(value, what)
    allowed = {str(one.value): one for one in bare(kind)}
    return None if text is None else _one_of(value, text, allowed, what, reading)


def _one_of(
    value: Value, text: str, allowed: dict[str, Any], what: str, reading: Reading
) -> Recipe | None:
    if text not in allowed:
        near = did_you_mean(text, allowed)
        reading.fail(value, f"{what} has no value '{text}'{near}")
        return None
    found = allowed[text]
    return lambda maker: found


def _items(value: Value, kind: Any, what: str, reading: Reading) -> Recipe | None:
    if not isinstance(value, Listing):
        reading.fail(value, f"{what} is a list, not {describe(value)}")
        return None
    inner = bare(kind)
    origin, arguments = typing.get_origin(inner) or inner, typing.get_args(inner)
    is_of_one_kind = origin is not tuple or not arguments or arguments[-1] is Ellipsis
    kinds = [arguments[0] if arguments else object] * len(value.items)
    if not is_of_one_kind:
        kinds = list(arguments)
        if len(kinds) != len(value.items):
            reading.fail(value, f"{what} has {len(kinds)} items, not {len(value.items)}")
            return None
    found = [
        read_given(one, item, f"{what}[{number}]", reading)
        for number, (one, item) in enumerate(zip(value.items, kinds, strict=True))
    ]
    recipes = [one for one in found if one is not None]
    if len(recipes) != len(found):
        return None
    kept: Callable[[list[Any]], Any] = origin if origin in (tuple, set, frozenset) else list
    return lambda maker: kept([recipe(maker) for recipe in recipes])


def _array(value: Value, kind: Any, what: str, reading: Reading) -> Recipe | None:
    numbers = _nested(value, kind, what, reading)
    if numbers is None:
        return None
    try:
        found = np.array(numbers, dtype=float)
    except ValueError:
        reading.fail(value, f"{what}: the rows of an array are of one length")
        return None
    return lambda maker: found.copy()


def _nested(value: Value, kind: Any, what: str, reading: Reading) -> Any:
    if not isinstance(value, Listing):
        number = typing.Annotated[float, dimension_of(kind)] if dimension_of(kind) else float
        return _number(value, number, what, reading)
    found = [_nested(one, kind, what, reading) for one in value.items]
    return None if any(one is None for one in found) else found


def _object(value: Value, kind: Any, what: str, reading: Reading) -> Recipe | None:
    cls: type = typing.get_origin(bare(kind)) or bare(kind)
    if not isinstance(value, Table):
        told = f"{what} is a {type_name(kind)}: give some of its fields, {{{_shown(cls)}}}"
        reading.fail(value, f"{told}, not {describe(value)}")
        return None
    given: dict[str, Recipe] = {}
    known, is_whole = fields_of(cls), True
    for name, entry in value.entries.items():
        field = field_name(cls, name)
        if field not in known:
            near = did_you_mean(name, known)
            reading.problems.error(entry.key_mark, f"{cls.__name__} has no field '{name}'{near}")
            is_whole = False
            continue
        recipe = read_given(entry.value, known[field], f"{what}.{name}", reading)
        is_whole = is_whole and recipe is not None
        if recipe is not None:
            given[field] = recipe
    return (lambda maker: maker.stand_in(cls, what, given)) if is_whole else None


def _shown(cls: type, most: int = 4) -> str:
    fields: Sequence[str] = tuple(fields_of(cls))
    return ", ".join(f"{name}: …" for name in fields[:most])
