"""The faults of plugins: what a verb does instead of its work."""

import os
import time
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from executive.errors import ExecutiveError

_EXIT_STATUS = 86  # of a process that a fault ends
_LOOK_S = 0.01  # how often a call that hangs can be interrupted


class InjectedError(ExecutiveError):
    """What a verb raises that the mission file lets raise."""


def misbehave(how: str, delay_s: float, call: Callable[[], Any]) -> Any:
    """Do what a fault says instead of a call; `late` and `nan` begin with the call itself.

    Args:
        how: `raise`, `hang`, `die`, `late`, `nan` or `wrong_type`; the call alone if empty.
        delay_s: Of `late`: time on the wall by which the answer comes later [s].
        call: The verb with its arguments.
    """
    if how == "raise":
        raise InjectedError("a fault on purpose, by the mission's `faults:`")
    if how == "hang":
        while True:
            time.sleep(_LOOK_S)  # noqa: TID251 - it hangs on the wall clock, as a real fault does
    if how == "die":
        os._exit(_EXIT_STATUS)
    if how == "wrong_type":
        return {"fault on purpose": "no verb answers with a mapping of texts"}
    value = call()
    if how == "late":
        time.sleep(delay_s)  # noqa: TID251 - late on the wall clock, as a real fault is
    return with_nan(value) if how == "nan" else value


def with_nan(value: Any) -> Any:
    """Return a value of the same type whose floating-point numbers are all NaN."""
    if isinstance(value, float):
        return float("nan")
    if isinstance(value, np.ndarray):
        return np.full_like(value, np.nan) if value.dtype.kind == "f" else value
    if isinstance(value, tuple) and not hasattr(value, "_fields"):
        return tuple(with_nan(one) for one in value)
    if isinstance(value, list):
        return [with_nan(one) for one in value]
    if isinstance(value, Mapping):
        return {key: with_nan(one) for key, one in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        copy = object.__new__(type(value))
        for one in fields(value):  # past the checks of the class, which would refuse NaN
            object.__setattr__(copy, one.name, with_nan(getattr(value, one.name)))
        return copy
    return value
