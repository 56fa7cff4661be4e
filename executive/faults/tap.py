"""Puts a function in front of a method of one object, for all who call it."""

from collections.abc import Callable
from functools import wraps
from types import MethodType
from typing import Any


def tap(owner: Any, verb: str, around: Callable[..., Any]) -> None:
    """Replace a method of one object by `around(method, *args, **kwargs)`.

    The class stays as it is, and the object stays what it is to all who hold it. A traceback shows
    the object as `self` of the replacement, so that an error is attributed to it.
    """
    method = getattr(owner, verb)

    @wraps(method)
    def replacement(self: Any, *args: Any, **kwargs: Any) -> Any:
        return around(method, *args, **kwargs)

    object.__setattr__(owner, verb, MethodType(replacement, owner))
