"""Calls of compiled code without the choice among its variants."""

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def direct(compiled: Callable[P, R]) -> Callable[P, R]:
    """Return the code of a compiled function that has one signature.

    Called otherwise, the types of all arguments are compared with the variants that there are. For
    arrays that are read-only or hold records this takes some microseconds after a pause, while
    the arithmetic of a sample takes one. The caller answers for the types instead: for an array,
    only the size of its items is checked.

    Raises:
        ValueError: If the function has another number of signatures.
    """
    dispatcher: Any = compiled
    (signature,) = dispatcher.signatures
    code: Callable[P, R] = dispatcher.overloads[signature].entry_point
    return code
