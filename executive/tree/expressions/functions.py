"""The functions of expressions: what each takes, what it gives, how it is computed."""

import math
import typing
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from executive.tree.expressions.dimension import PLAIN
from executive.tree.expressions.kinds import (
    COUNT,
    bare,
    clash,
    dimension_of,
    item_of,
    members,
    number,
    sort_of,
)

_ANY_NUMBER = 20  # of arguments


class RefusedError(Exception):
    """Arguments that an operation cannot take; the message says why."""


@dataclass(frozen=True, slots=True)
class Rule:
    """A function.

    Attributes:
        least: Smallest number of arguments.
        most: Largest number of arguments.
        result: Returns the type of the result from the types of the arguments.
        compute: Returns the result.
        form: How it is written, and what it gives.
    """

    least: int
    most: int
    result: Callable[[str, Sequence[Any]], Any]
    compute: Callable[..., Any]
    form: str

    def told(self, name: str, got: int) -> str:
        """Say how many arguments the function takes."""
        wanted = f"{self.least}" if self.least == self.most else f"at least {self.least}"
        plural = "" if wanted == "1" else "s"
        return f"'{name}' takes {wanted} argument{plural}, got {got}: {self.form}"


def shown(kind: Any) -> str:
    """Return a type for a sentence."""
    sort = sort_of(kind)
    dimension = dimension_of(kind)
    if sort == "number":
        name = "number" if dimension is None or dimension == PLAIN else str(dimension)
        return f"{'an' if name.startswith('a') else 'a'} {name}"
    if sort == "choice" or sort == "object":
        return str(getattr(typing.get_origin(bare(kind)) or bare(kind), "__name__", kind))
    article = "an" if sort in ("array", "unknown") else "a"
    words = {"truth": "true or false", "missing": "nothing", "unknown": "an unknown value"}
    return words.get(sort, f"{article} {sort}")


def _length(name: str, kinds: Sequence[Any]) -> Any:
    if sort_of(kinds[0]) not in ("list", "array", "mapping", "text", "unknown"):
        raise RefusedError(f"'{name}' needs a list or a text, not {shown(kinds[0])}")
    return COUNT


def _extreme(name: str, kinds: Sequence[Any]) -> Any:
    """Return the type of `min`, `max` or `sum` of one list, or of several numbers."""
    if len(kinds) == 1:
        if sort_of(kinds[0]) == "unknown":
            return Any
        if sort_of(kinds[0]) not in ("list", "array"):
            raise RefusedError(f"'{name}' of one argument needs a list, not {shown(kinds[0])}")
        kinds = members(item_of(kinds[0]))
    wrong = next((kind for kind in kinds if sort_of(kind) not in ("number", "unknown")), None)
    if wrong is not None:
        raise RefusedError(f"'{name}' needs numbers, not {shown(wrong)}")
    return _common(name, kinds)


def _common(name: str, kinds: Sequence[Any]) -> Any:
    known = [kind for kind in kinds if dimension_of(kind) is not None]
    for one in known:
        for other in known:
            if cure := clash(one, other):
                told = f"'{name}' cannot compare {shown(one)} and {shown(other)}"
                raise RefusedError(f"{told}; {cure}")
    measured = [kind for kind in known if dimension_of(kind) != PLAIN]
    return (measured or list(kinds))[0]


def _magnitude(name: str, kinds: Sequence[Any]) -> Any:
    if sort_of(kinds[0]) not in ("number", "unknown"):
        raise RefusedError(f"'{name}' needs a number, not {shown(kinds[0])}")
    return kinds[0]


def _distance(name: str, kinds: Sequence[Any]) -> Any:
    for kind in kinds:
        if sort_of(kind) not in ("array", "list", "unknown"):
            raise RefusedError(f"'{name}' needs two points such as {{stone.centroid_map}}, not "
                          f"{shown(kind)}")  # fmt: skip
    inner = [item_of(kind) for kind in kinds if sort_of(kind) != "unknown"]
    return _common(name, inner) if inner else number(None)


def _text(_: str, __: Sequence[Any]) -> Any:
    return str


def compute_distance(one: Any, other: Any) -> float:
    """Return the straight distance of two points of the same number of coordinates."""
    return math.dist([float(x) for x in one], [float(x) for x in other])


def as_text(value: Any) -> str:
    """Return a value as a person reads it: a number with six digits, a choice by its value."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        return ", ".join(map(as_text, value))
    return str(value)


RULES = {
    "len": Rule(1, 1, _length, len, "len({list}) is the number of its items"),
    "min": Rule(1, _ANY_NUMBER, _extreme, min, "min({a}, {b}) or min({list}) is the smallest"),
    "max": Rule(1, _ANY_NUMBER, _extreme, max, "max({a}, {b}) or max({list}) is the largest"),
    "sum": Rule(1, 1, _extreme, sum, "sum({list}) is the sum of a list of numbers"),
    "abs": Rule(1, 1, _magnitude, abs, "abs({a}) is the number without its sign"),
    "distance": Rule(2, 2, _distance, compute_distance, "distance({a}, {b}) of two points"),
    "text": Rule(
        1,
        _ANY_NUMBER,
        _text,
        lambda *values: "".join(map(as_text, values)),
        "text({a}, ' of ', {b}) joins values to a text",
    ),
}
