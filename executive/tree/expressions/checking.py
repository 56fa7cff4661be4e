"""The type of an expression before the run, and every mistake in it with its place.

A key may hold one of several types, depending on the path to the expression. What is reported is
what must fail: an operation that fits no combination of the types of its parts.
"""

import typing
from collections.abc import Callable, Mapping
from itertools import product
from typing import Any

from executive.errors import did_you_mean
from executive.tree.expressions.dimension import unit_dimension
from executive.tree.expressions.functions import RULES, RefusedError, shown
from executive.tree.expressions.kinds import (
    COUNT,
    bare,
    field_name,
    fields_of,
    item_of,
    members,
    number,
    sort_of,
    written,
)
from executive.tree.expressions.operators import is_of, operation_type
from executive.tree.expressions.presence import asked_for
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
)

Types = frozenset[Any]
UNKNOWN: Types = frozenset({Any})
NOTHING: Types = frozenset()  # the type of what was refused already


class Typing:
    """Finds the types of an expression.

    Args:
        key: Returns the types that a key may hold; it reports a key that nothing has written, and
            then returns none. The flag says that the key may be missing, as in `has({key})`.
        fail: Takes the offset of a mistake and the message.
    """

    def __init__(self, key: Callable[[Key, bool], Types], fail: Callable[[int, str], None]) -> None:
        self._key = key
        self._fail = fail
        self._items: Mapping[str, Types] = {}
        self._present: frozenset[str] = frozenset()  # what `has` has been asked for

    def types(self, one: Expression) -> Types:  # noqa: C901 - one case a part
        """Return what an expression may give; nothing after a mistake, which is reported."""
        match one:
            case Number(value=value, unit=unit):
                if unit:
                    return frozenset({number(unit_dimension(unit))})
                kind: Any = type(value)
                return frozenset({written(kind)})
            case Text():
                return frozenset({typing.Literal[one.value]})
            case Truth():
                return frozenset({bool})
            case Key():
                return self._of_key(one, may_miss=False)
            case Field():
                return self._field(one)
            case Index():
                return self._index(one)
            case Listed():
                return self._listed(one)
            case Unary():
                return self._unary(one)
            case Binary():
                return self._binary(one)
            case Function():
                return self._function(one)
            case Over():
                return self._over(one)

    def truth(self, one: Expression) -> Types:
        """Return the types of an expression that must be true or false."""
        return self._truth(one, "it")

    # --- keys and what is in them

    def _of_key(self, one: Key, *, may_miss: bool) -> Types:
        if one.name in self._items:
            return self._items[one.name]
        found = self._key(one, may_miss or self._is_present(one))
        return _split(found)

    def _is_present(self, one: Expression) -> bool:
        return bool(self._present) and str(one) in self._present

    def _there(self, one: Expression) -> Types:
        """Return the types of a value that must not be missing."""
        found = self.types(one)
        if self._is_present(one):
            return _without_missing(found)
        return self._refuse_missing(one, found)

    def _refuse_missing(self, one: Expression, found: Types) -> Types:
        if any(sort_of(kind) == "missing" for kind in found):
            told = f"{one} may be missing; ask 'has({one}) and …' before, or write 'default({one},"
            self._fail(one.at, f"{told} …)'")
            return NOTHING
        return found

    def _field(self, one: Field) -> Types:
        found = self._there(one.of)
        results: set[Any] = set()
        known: set[str] = set()
        for kind in found:
            if sort_of(kind) == "unknown":
                results.add(Any)
            elif sort_of(kind) == "object":
                fields = fields_of(_class(kind))
                known.update(fields)
                name = field_name(_class(kind), one.name)
                results.update([fields[name]] if name in fields else [])
        if found and not results:
            near = did_you_mean(one.name, known) if known else ""
            self._fail(one.at, f"{_names(found)} has no field '{one.name}'{near}")
        return _split(frozenset(results))

    def _index(self, one: Index) -> Types:
        found, index = self._there(one.of), self._there(one.index)
        results = set()
        for kind, by in product(found, index):
            wanted = {"mapping": ("text",), "unknown": ("number", "text")}.get(
                sort_of(kind), ("number",)
            )
            if sort_of(kind) in ("list", "array", "mapping", "unknown") and is_of(by, wanted):
                results.add(Any if sort_of(kind) == "unknown" else item_of(kind))
        if found and index and not results:
            self._fail(one.at, f"{_names(found)} has no item [{_names(index)}]")
        return _split(frozenset(results))

    def _listed(self, one: Listed) -> Types:
        kinds: set[Any] = set()
        for item in one.items:
            kinds.update(self._there(item) or UNKNOWN)
        if not kinds:
            return frozenset({list})
        return frozenset({list[typing.Union[tuple(kinds)]]})  # type: ignore[misc]  # noqa: UP007

    # --- operators

    def _truth(self, one: Expression, what: str) -> Types:
        found = self._there(one)
        if found and not any(is_of(kind, ("truth",)) for kind in found):
            self._fail(one.at, f"{what} needs true or false, and {one} is {_names(found)}")
            return NOTHING
        return frozenset({bool}) if found else NOTHING

    def _unary(self, one: Unary) -> Types:
        if one.op == "not":
            return self._truth(one.of, "'not'")
        found = self._there(one.of)
        kept = frozenset(kind for kind in found if is_of(kind, ("number",)))
        if found and not kept:
            self._fail(one.at, f"'-' needs a number, and {one.of} is {_names(found)}")
        return kept

    def _binary(self, one: Binary) -> Types:
        if one.op in ("and", "or"):
            return self._joined(one)
        left, right = self._there(one.left), self._there(one.right)
        results, refusal = set(), ""
        for pair in product(left, right):
            try:
                results.add(operation_type(one.op, *pair))
            except RefusedError as error:
                refusal = refusal or str(error)
        if refusal and not results:
            self._fail(one.at, refusal)
        return frozenset(results)

    def _joined(self, one: Binary) -> Types:
        left = self._truth(one.left, f"'{one.op}'")
        before = self._present
        self._present = before | asked_for(one.left, one.op == "and")
        right = self._truth(one.right, f"'{one.op}'")
        self._present = before
        return left & right

    # --- functions

    def _function(self, one: Function) -> Types:
        if one.name in ("has", "default"):
            return self._missing(one)
        rule = RULES[one.name]
        if not rule.least <= len(one.arguments) <= rule.most:
            self._fail(one.at, rule.told(one.name, len(one.arguments)))
            return NOTHING
        given = [self._there(argument) for argument in one.arguments]
        if not all(given):
            return NOTHING
        results, refusal = set(), ""
        for kinds in product(*given):
            try:
                results.add(rule.result(one.name, kinds))
            except RefusedError as error:
                refusal = refusal or str(error)
        if not results:
            self._fail(one.at, refusal)
        return frozenset(results)

    def _missing(self, one: Function) -> Types:
        wanted = 1 if one.name == "has" else 2
        if len(one.arguments) != wanted or not isinstance(one.arguments[0], Key | Field | Index):
            form = "has({key})" if one.name == "has" else "default({key}, value)"
            self._fail(one.at, f"'{one.name}' is written '{form}'")
            return NOTHING
        found = self._of_missing(one.arguments[0])
        if one.name == "has":
            return frozenset({bool})
        return _without_missing(found) | self._there(one.arguments[1])

    def _of_missing(self, one: Expression) -> Types:
        if isinstance(one, Key):
            return self._of_key(one, may_miss=True)
        root: Expression = one
        while isinstance(root, Field | Index):
            root = root.of
        if not isinstance(root, Key):
            return self.types(one)
        before = self._present
        parts: set[str] = set()
        part: Expression = one
        while isinstance(part, Field | Index):  # each part of the path may be missing
            part = part.of
            parts.add(str(part))
        self._present = before | parts
        found = self.types(one)
        self._present = before
        return found

    def _over(self, one: Over) -> Types:
        source = self._there(one.source)
        items = frozenset(
            member
            for kind in source
            if sort_of(kind) in ("list", "array", "unknown")
            for member in members(Any if sort_of(kind) == "unknown" else item_of(kind))
        )
        if source and not items:
            self._fail(one.at, f"'{one.name}' goes through a list, not {_names(source)}")
        before = self._items
        self._items = {**before, one.item: items}
        body = self._there(one.body) if one.name == "each" else self._truth(one.body, one.name)
        self._items = before
        if not items or not body:
            return NOTHING
        kept = items if one.name == "only" else body
        listed: Any = list[typing.Union[tuple(kept)]]  # type: ignore[misc]  # noqa: UP007
        return frozenset({{"any": bool, "all": bool, "count": COUNT}.get(one.name, listed)})


def _split(found: Types) -> Types:
    if all(map(_is_plain, found)):
        return found
    return frozenset(_listed(member) for kind in found for member in members(kind))


def _is_plain(kind: Any) -> bool:
    """Return whether a type is one class, neither a union nor a tuple."""
    inner = bare(kind)
    return type(inner) is type and inner is not tuple


def _listed(kind: Any) -> Any:
    """Return the type of a tuple as that of a list, which is what it is read as."""
    inner = bare(kind)
    return list[item_of(kind)] if typing.get_origin(inner) is tuple else kind  # type: ignore[misc]


def _without_missing(found: Types) -> Types:
    return frozenset(kind for kind in found if sort_of(kind) != "missing")


def _class(kind: Any) -> type:
    inner = bare(kind)
    found: type = typing.get_origin(inner) or inner
    return found


def _names(found: Types) -> str:
    return " or ".join(sorted(shown(kind) for kind in found))
