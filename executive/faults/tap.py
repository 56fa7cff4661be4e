"""Puts a function in front of a method of one object, for all who call it."""

from collections.abc import Callable
from functools import wraps
from types import MethodType
from typing import Any


def tap(owner: Any, verb: str, around: Callable[..., Any]) -> None:
    """Replace a method of one object by `around(method, *args, **kwargs)`.

    The class stays as it is, and the object stays what it is to all who hold it.
    """
    object.__setattr__(owner, verb, wrapped(owner, verb, getattr(owner, verb), around))


def wrapped(
    owner: Any, verb: str, method: Callable[..., Any], around: Callable[..., Any]
) -> MethodType:
    """Return `around(method, *args, **kwargs)` as a method of an object.

    A traceback shows the object as `self` of a function of the verb's name, so that an error is
    attributed to both.
    """

    def replacement(self: Any, *args: Any, **kwargs: Any) -> Any:
        return around(method, *args, **kwargs)

    replacement.__code__ = replacement.__code__.replace(co_name=verb)
    return MethodType(wraps(method)(replacement), owner)
