"""Expressions of a mission as scripts of BehaviorTree.CPP 4.

A script knows keys, numbers, texts, `true` and `false`, arithmetic, comparisons and logic.
Quantities are written in SI units. Fields, lists and functions have no counterpart.
"""

from typing import Any

from executive.tree.expressions.dimension import in_si
from executive.tree.expressions.syntax import (
    COMPARISONS,
    Binary,
    Expression,
    Key,
    Number,
    Text,
    Truth,
    Unary,
)
from executive.tree.key_source import Computed, Literally, Ref, Source
from executive.tree.node_kinds import Set

_OPERATORS = {"and": "&&", "or": "||"}
_NO_OPERATORS = ("in", "not in")
_HIGHEST = 10
_BINDING = {"||": 1, "&&": 2, **dict.fromkeys(COMPARISONS, 3), "+": 4, "-": 4, "*": 5, "/": 5}


def condition_script(expression: Expression) -> str | None:
    """Return a condition as a script, or None if scripts cannot say it."""
    return _script(expression, 0)


def assignment(key: str, source: Source) -> str | None:
    """Return the script that writes a value to a key, or None if scripts cannot say it."""
    value = _value(source)
    return None if value is None else f"{key} := {value}"


def set_script(kind: Set) -> str | None:
    """Return a `set` as one script, or None if scripts cannot say all of it."""
    parts = [assignment(key, source) for key, source in kind.values.items()]
    known = [part for part in parts if part is not None]
    return "; ".join(known) if len(known) == len(parts) else None


def _value(source: Source) -> str | None:
    if isinstance(source, Ref):
        return source.key
    if isinstance(source, Computed):
        return _script(source.expression, 0)
    return _literal(source.value) if isinstance(source, Literally) else None


def _literal(value: Any) -> str | None:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return repr(value) if value >= 0 else f"-{-value!r}"
    if isinstance(value, str) and "'" not in value and "\n" not in value:
        return f"'{value}'"
    return None


def _script(one: Expression, strength: int) -> str | None:
    match one:
        case Key(name=name):
            return name
        case Number(value=value, unit=unit):
            return _literal(in_si(value, unit))
        case Text(value=value) | Truth(value=value):
            return _literal(value)
        case Unary(op=op, of=of):
            inner = _script(of, _HIGHEST)
            return inner and f"{'!' if op == 'not' else '-'}{inner}"
        case Binary(op=op, left=left, right=right) if op not in _NO_OPERATORS:
            return _binary(_OPERATORS.get(op, op), left, right, strength)
    return None


def _binary(sign: str, left: Expression, right: Expression, strength: int) -> str | None:
    own = _BINDING[sign]
    # A script reads `a < b < c` as a chain, so a comparison within one is put in parentheses.
    first = _script(left, own + 1 if sign in COMPARISONS else own)
    second = _script(right, own + 1)
    if first is None or second is None:
        return None
    text = f"{first} {sign} {second}"
    return f"({text})" if own < strength else text
