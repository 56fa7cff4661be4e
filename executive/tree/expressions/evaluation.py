"""The value of an expression during the run."""

import operator
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from executive.errors import ConfigError, did_you_mean
from executive.leaf.store import Store
from executive.tree.expressions.dimension import in_si
from executive.tree.expressions.functions import RULES, as_text
from executive.tree.expressions.kinds import field_name, fields_of
from executive.tree.expressions.syntax import (
    Binary,
    Expression,
    Field,
    Function,
    Index,
    Key,
    Listed,
    Number,
    Over,
    Text,
    Truth,
    Unary,
    parts_of,
)

_OPERATIONS: Mapping[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "in": lambda one, many: one in many,
    "not in": lambda one, many: one not in many,
}
_UNUSABLE = (TypeError, ValueError, ArithmeticError, LookupError, AttributeError)


def evaluate(one: Expression, store: Store) -> Any:
    """Return the value of an expression; quantities are in SI units.

    Raises:
        ConfigError: If a key was never written, or the values do not allow an operation, such as a
            division by zero or an item that a list does not have.
    """
    try:
        return _Evaluation(store, {}).value(one)
    except _UNUSABLE as error:
        told = str(_reason(error)) or type(error).__name__
        raise ConfigError(f"'{one}' cannot be computed: {told}") from error


def _reason(error: Exception) -> object:
    """Return what an error says; as a text, a KeyError is its key in quotation marks."""
    return error.args[0] if isinstance(error, KeyError) and error.args else error


def values_in(one: Expression, store: Store) -> str:
    """Return the numbers, texts and truth values that an expression reads, for a reason."""
    told: dict[str, str] = {}
    for path in _paths(one):
        try:
            value = evaluate(path, store)
        except ConfigError:
            continue
        if isinstance(value, bool | int | float | str):
            told[str(path)] = as_text(value)
    return ", ".join(f"{path} = {value}" for path, value in told.items())


def _paths(one: Expression) -> Iterator[Expression]:
    """Yield the keys with their fields, outside of `any` and its like."""
    root = one
    while isinstance(root, Field | Index):
        root = root.of
    if isinstance(root, Key):
        yield one
    elif not isinstance(one, Over):
        for part in parts_of(one):
            yield from _paths(part)


class _Evaluation:
    def __init__(self, store: Store, items: Mapping[str, Any]) -> None:
        self._store = store
        self._items = items

    def value(self, one: Expression) -> Any:  # noqa: C901 - one case a part
        match one:
            case Number(value=number, unit=unit):
                return in_si(number, unit)
            case Text(value=value) | Truth(value=value):
                return value
            case Key(name=name):
                found = self._items[name] if name in self._items else self._store.get(name)
                return _plain(found)
            case Field(of=of, name=name):
                return _plain(_field(self.value(of), name))
            case Index(of=of, index=index):
                return _plain(_item(self.value(of), self.value(index)))
            case Listed(items=items):
                return [self.value(item) for item in items]
            case Unary(op="not", of=of):
                return not self._truth(of)
            case Unary(of=of):
                return -self.value(of)
            case Binary(op="and", left=left, right=right):
                return self._truth(left) and self._truth(right)
            case Binary(op="or", left=left, right=right):
                return self._truth(left) or self._truth(right)
            case Binary(op=op, left=left, right=right):
                return _plain(_OPERATIONS[op](self.value(left), self.value(right)))
            case Function():
                return self._function(one)
            case Over():
                return self._over(one)

    def _truth(self, one: Expression) -> bool:
        value = self.value(one)
        if not isinstance(value, bool):
            raise TypeError(f"{one} is {value!r}, not true or false")
        return value

    def _function(self, one: Function) -> Any:
        if one.name == "has":
            return self._found(one.arguments[0]) is not None
        if one.name == "default":
            found = self._found(one.arguments[0])
            return self.value(one.arguments[1]) if found is None else found
        return _plain(RULES[one.name].compute(*map(self.value, one.arguments)))

    def _found(self, one: Expression) -> Any:
        """Return a value, or None if a part of the path to it is missing."""
        if isinstance(one, Key):
            is_known = one.name in self._items or one.name in self._store
            return self.value(one) if is_known else None
        if isinstance(one, Field):
            of = self._found(one.of)
            return None if of is None else _plain(_field(of, one.name))
        if isinstance(one, Index):
            of = self._found(one.of)
            try:
                return None if of is None else _plain(_item(of, self.value(one.index)))
            except LookupError:
                return None
        return self.value(one)

    def _over(self, one: Over) -> Any:
        within = (
            _Evaluation(self._store, {**self._items, one.item: item})
            for item in self.value(one.source)
        )
        if one.name == "each":
            return [each.value(one.body) for each in within]
        if one.name == "only":
            return [_plain(each._items[one.item]) for each in within if each._truth(one.body)]
        answers = (each._truth(one.body) for each in within)
        if one.name == "count":
            return sum(answers)
        return any(answers) if one.name == "any" else all(answers)


def _field(of: Any, name: str) -> Any:
    cls: type = type(of)
    known, name = fields_of(cls), field_name(cls, name)
    if name not in known:
        near = did_you_mean(name, known)
        raise AttributeError(f"{cls.__name__} has no field '{name}'{near}")
    return getattr(of, name)


def _item(of: Any, index: Any) -> Any:
    if isinstance(of, Mapping):
        if index not in of:
            raise LookupError(f"there is no entry '{index}'")
        return of[index]
    if isinstance(index, bool) or not isinstance(index, int):
        raise TypeError(f"an item's number is whole, not {index!r}")
    if not -len(of) <= index < len(of):
        raise LookupError(f"there is no item {index} in a list of {len(of)}")
    return of[index]


def _plain(value: Any) -> Any:
    """Return a numpy scalar as Python's own, and a tuple as a list, which is what ports take."""
    if isinstance(value, np.generic):
        return value.item()
    return list(value) if type(value) is tuple else value
