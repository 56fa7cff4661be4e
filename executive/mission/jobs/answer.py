"""Whether a verb returned what the interface of its capability says that it returns."""

import types
import typing
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from itertools import islice
from typing import Any, cast

import numpy as np

from executive.interfaces.plugin import Plugin
from executive.messages.parts import place_of_nan

_LOOKED_AT = 1000  # elements of a container that are checked: a share of a tick at most


def unfit(plugin: Plugin, verb: str, value: object) -> str:
    """Return why a value is no answer of a verb, such as `dict instead of Plan`; else "".

    The type is the return annotation of the interface: the class that names the capability. A verb
    that is in no interface, or has no annotation, may return any type. No answer may hold a NaN.
    """
    wanted, plain = _answer_type(cast(Any, type(plugin)), verb)
    if value is None and plain is type(None):
        return ""
    reason = "" if plain and isinstance(value, plain) else _unfit(value, wanted)
    if not reason and (place := place_of_nan(value, _LOOKED_AT)):
        return f"NaN ({place})"
    return reason


@cache
def _answer_type(plugin_class: Any, verb: str) -> tuple[Any, type | None]:
    """Return what a verb answers with, and the same if it is a class whose instances all fit."""
    wanted = _annotation(plugin_class, verb)
    is_plain = isinstance(wanted, type) and wanted not in (int, float, bool, object, Any)
    return wanted, wanted if is_plain and not getattr(wanted, "_is_protocol", False) else None


def _annotation(plugin_class: Any, verb: str) -> Any:
    for one in reversed(plugin_class.__mro__):
        if "capability" in vars(one) and one is not Plugin and verb in vars(one):
            try:
                return typing.get_type_hints(vars(one)[verb]).get("return", Any)
            except (
                NameError,
                TypeError,
                AttributeError,
            ):  # it is for type checkers alone
                return Any
    return Any


def _unfit(value: object, wanted: Any) -> str:
    if wanted is Any or wanted is object or isinstance(wanted, typing.TypeVar):
        return ""
    origin, arguments = typing.get_origin(wanted), typing.get_args(wanted)
    if origin in (typing.Union, types.UnionType):
        reasons = [_unfit(value, one) for one in arguments]
        return "" if "" in reasons else _instead(value, wanted)
    if origin is typing.Annotated:
        return _unfit(value, arguments[0])
    if origin is typing.Literal:
        return "" if value in arguments else f"{value!r} instead of {wanted}"
    if not _is_instance(value, origin or wanted):
        return _instead(value, wanted)
    return _unfit_elements(value, origin, arguments)


def _is_instance(value: object, wanted: Any) -> bool:
    if wanted is None:
        return value is None
    if not isinstance(wanted, type) or getattr(wanted, "_is_protocol", False):
        return True
    if wanted is float:  # an integer is a number, and a truth value is none
        return isinstance(value, float | int | np.floating | np.integer) and not isinstance(
            value, bool
        )
    if wanted is int:
        return isinstance(value, int | np.integer) and not isinstance(value, bool)
    if wanted is bool:
        return isinstance(value, bool | np.bool_)
    return isinstance(value, wanted)


def _unfit_elements(value: object, origin: Any, arguments: tuple[Any, ...]) -> str:
    """Check elements of tuples, sequences and mappings; an array's type is checked by messages."""
    pairs: Iterable[tuple[object, Any]] = ()
    if isinstance(value, np.ndarray) or not arguments:
        return ""
    if origin is tuple and Ellipsis not in arguments:
        if isinstance(value, tuple) and len(value) != len(arguments):
            return f"a tuple of {len(value)} instead of {len(arguments)}"
        pairs = zip(cast(tuple[object, ...], value), arguments, strict=True)
    elif isinstance(value, Mapping):
        pairs = ((one, arguments[1]) for one in islice(value.values(), _LOOKED_AT))
    elif isinstance(value, Sequence | set | frozenset):
        pairs = ((one, arguments[0]) for one in islice(value, _LOOKED_AT))
    return next((f"{why} within it" for one, kind in pairs if (why := _unfit(one, kind))), "")


def _instead(value: object, wanted: Any) -> str:
    name = wanted.__name__ if isinstance(wanted, type) else str(wanted).replace("typing.", "")
    return f"{type(value).__name__} instead of {name}"
