"""Records of which a test cares about a few fields only, such as reports for metrics."""

import types
import typing
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from typing import Any, TypeVar, cast

import numpy as np

_T = TypeVar("_T")
_SCALARS: Mapping[type, object] = {int: 0, float: 0.0, str: "", bool: False}


def blank(kind: type[_T], **given: object) -> _T:
    """Return a frozen dataclass with the given fields, and with an empty value in every other.

    A number is 0, a text empty, an array of shape (3,) zero, a choice the first one, and what may
    be None is None; a record within it is blank as well. Use it to test a metric on a run that is
    made up: `RunRecord(blank(MissionReport, outcome="failure"))`.

    Raises:
        TypeError: If the class has no field of a given name, or a field has a type that no report
            and no event has.
    """
    hints = typing.get_type_hints(kind)
    needed = [
        one.name
        for one in fields(cast(Any, kind))
        if one.default is MISSING and one.default_factory is MISSING
    ]
    return kind(**{**{name: _empty(hints[name]) for name in needed}, **given})


def _empty(wanted: Any) -> object:
    origin, arguments = typing.get_origin(wanted), typing.get_args(wanted)
    if origin in (typing.Union, types.UnionType):
        return None if type(None) in arguments else _empty(arguments[0])
    if origin is np.ndarray:
        return np.zeros(3)
    if origin is typing.Literal:
        return arguments[0]
    if origin is tuple:
        return () if arguments[-1] is Ellipsis else tuple(map(_empty, arguments))
    if origin is not None and issubclass(origin, Mapping):
        return {}
    if wanted in _SCALARS:
        return _SCALARS[wanted]
    if is_dataclass(wanted) and isinstance(wanted, type):
        return blank(wanted)
    raise TypeError(f"no empty value for {wanted!r}")
