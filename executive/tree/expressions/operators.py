"""The types that operators take and give: `+`, `<`, `in`, and why others are refused."""

import typing
from typing import Any

from executive.errors import did_you_mean
from executive.tree.expressions.dimension import Dimension
from executive.tree.expressions.functions import RefusedError, shown
from executive.tree.expressions.kinds import (
    bare,
    clash,
    dimension_of,
    is_written,
    item_of,
    members,
    number,
    sort_of,
    written,
)
from executive.tree.expressions.syntax import COMPARISONS


def operation_type(op: str, left: Any, right: Any) -> Any:
    """Return the type of what an operator gives.

    Raises:
        RefusedError: If it takes no values of these types; the message says why.
    """
    if op in ("in", "not in"):
        return _contained(left, right)
    if op in ("==", "!="):
        return _compared(op, left, right, equal=True)
    if op in COMPARISONS:
        return _compared(op, left, right, equal=False)
    return _computed(op, left, right)


def _contained(left: Any, right: Any) -> Any:
    if not is_of(right, ("list", "text", "mapping")):
        raise RefusedError(f"'in' needs a list or a text on its right, not {shown(right)}")
    if sort_of(right) == "list":
        for one in members(item_of(right)):
            try:
                return _compared("==", left, one, equal=True)
            except RefusedError as error:
                refusal = error
        raise refusal
    if not is_of(left, ("text", "choice")):
        raise RefusedError(f"{shown(left)} cannot be in {shown(right)}")
    return bool


def _compared(op: str, left: Any, right: Any, *, equal: bool) -> Any:
    sorts = {sort_of(left), sort_of(right)}
    if "unknown" in sorts:
        return bool
    if sorts == {"number"}:
        _same_dimension("compare", left, right)
        return bool
    if sorts == {"text"} or (equal and sorts in ({"truth"}, {"list"})):
        return bool
    if equal and "choice" in sorts and sorts <= {"choice", "text"}:
        _check_choice(left, right)
        return bool
    cure = "" if equal or len(sorts) > 1 else "; only numbers and texts have an order"
    raise RefusedError(f"'{op}' cannot compare {shown(left)} and {shown(right)}{cure}")


def _check_choice(left: Any, right: Any) -> None:
    choice, other = (left, right) if sort_of(left) == "choice" else (right, left)
    if typing.get_origin(other) is typing.Literal:
        word, known = typing.get_args(other)[0], [str(one.value) for one in bare(choice)]
        if word not in known:
            near = did_you_mean(word, known)
            raise RefusedError(f"{shown(choice)} is never '{word}'{near or _list(known)}")
    elif sort_of(other) == "choice" and bare(other) is not bare(choice):
        raise RefusedError(f"{shown(left)} is never equal to {shown(right)}")


def _list(known: list[str]) -> str:
    return f"; it is one of {', '.join(known)}"


def _computed(op: str, left: Any, right: Any) -> Any:
    sorts = {sort_of(left), sort_of(right)}
    if "unknown" in sorts:
        return Any
    if op == "+" and sorts == {"text"}:
        return str
    if op == "+" and sorts == {"list"}:
        return list[typing.Union[item_of(left), item_of(right)]]  # type: ignore[misc]  # noqa: UP007
    if sorts != {"number"}:
        cure = "; join texts with text(…, …)" if op == "+" and "text" in sorts else ""
        raise RefusedError(f"'{op}' needs two numbers, not {shown(left)} and {shown(right)}{cure}")
    is_whole = op != "/" and bare(left) is bare(right) is int
    if is_written(left) and is_written(right):
        return written(int if is_whole else float)
    return number(_dimension(op, left, right), int if is_whole else float)


def _dimension(op: str, left: Any, right: Any) -> Dimension | None:
    one, other = dimension_of(left), dimension_of(right)
    if op in ("+", "-"):
        _same_dimension({"+": "add", "-": "subtract"}[op], left, right)
        if one is None or (one.is_plain and other is not None):
            return other if other is None or not other.is_plain else one
        return one
    if one is None or other is None:
        return None
    return one * other if op == "*" else one / other


def _same_dimension(verb: str, left: Any, right: Any) -> None:
    cure = clash(left, right)
    if cure:
        raise RefusedError(f"cannot {verb} {shown(left)} and {shown(right)}; {cure}")


def is_of(kind: Any, sorts: tuple[str, ...]) -> bool:
    """Return whether a type is of one of some sorts, or not known."""
    return sort_of(kind) in (*sorts, "unknown")
