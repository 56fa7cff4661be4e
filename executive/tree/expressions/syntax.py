"""The syntax tree of an expression, and how it is written.

`str` of a tree gives a text that parses to an equal tree. `at` is the offset of a part within its
text; it does not count for equality.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

# How strongly an operator binds; a part that binds less than its place demands is put in
# parentheses.
BINDING = {
    "or": 1,
    "and": 2,
    "not": 3,
    **dict.fromkeys(("==", "!=", "<", "<=", ">", ">=", "in", "not in"), 4),
    **dict.fromkeys(("+", "-"), 5),
    **dict.fromkeys(("*", "/"), 6),
}
NEGATION = 7
COMPARISONS = frozenset(op for op, strength in BINDING.items() if strength == 4)
_ATOM = 8


@dataclass(frozen=True, slots=True)
class Number:
    """A number, with a unit if it is a quantity: `0.8 t`."""

    value: int | float
    unit: str = ""
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        return f"{self.value!r} {self.unit}" if self.unit else repr(self.value)


@dataclass(frozen=True, slots=True)
class Text:
    """A text in quotes, which holds no quote of the other kind if it holds one."""

    value: str
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        quote = '"' if "'" in self.value else "'"
        return f"{quote}{self.value}{quote}"


@dataclass(frozen=True, slots=True)
class Truth:
    """`true` or `false`."""

    value: bool
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        return str(self.value).lower()


@dataclass(frozen=True, slots=True)
class Key:
    """A key of the store: `{stone}`."""

    name: str
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        return f"{{{self.name}}}"


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a value: `{stone.mass}`."""

    of: "Expression"
    name: str
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        return _continued(self.of, f".{self.name}")


@dataclass(frozen=True, slots=True)
class Index:
    """One item of a list, or one value of a mapping: `{stones[0]}`."""

    of: "Expression"
    index: "Expression"
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        if _is_path(self):
            return _continued(self.of, f"[{self.index}]")
        return f"{_bound(self.of, _ATOM)}[{self.index}]"


@dataclass(frozen=True, slots=True)
class Listed:
    """A list: `[1 m, 2 m]`."""

    items: tuple["Expression", ...]
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        return f"[{', '.join(map(str, self.items))}]"


@dataclass(frozen=True, slots=True)
class Unary:
    """`-x` or `not x`."""

    op: str
    of: "Expression"
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        if self.op == "-":
            return f"-{_bound(self.of, NEGATION)}"
        return f"not {_bound(self.of, BINDING['not'])}"


@dataclass(frozen=True, slots=True)
class Binary:
    """An operator between two values; `at` is the place of the operator."""

    op: str
    left: "Expression"
    right: "Expression"
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        strength = BINDING[self.op]
        left = strength + 1 if self.op in COMPARISONS else strength
        return f"{_bound(self.left, left)} {self.op} {_bound(self.right, strength + 1)}"


@dataclass(frozen=True, slots=True)
class Function:
    """A function with its arguments: `len({stones})`."""

    name: str
    arguments: tuple["Expression", ...]
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        return f"{self.name}({', '.join(map(str, self.arguments))})"


@dataclass(frozen=True, slots=True)
class Over:
    """Something about each item of a list: `any(one in {stones}: {one.mass} > 0.8 t)`."""

    name: str
    item: str
    source: "Expression"
    body: "Expression"
    at: int = field(default=0, compare=False)

    def __str__(self) -> str:
        return f"{self.name}({self.item} in {self.source}: {self.body})"


Expression: TypeAlias = (
    Number | Text | Truth | Key | Field | Index | Listed | Unary | Binary | Function | Over
)


def parts_of(one: Expression) -> tuple[Expression, ...]:
    """Return the parts directly below."""
    match one:
        case Field(of=of) | Unary(of=of):
            return (of,)
        case Index(of=of, index=index):
            return (of, index)
        case Listed(items=items):
            return items
        case Binary(left=left, right=right):
            return (left, right)
        case Function(arguments=arguments):
            return arguments
        case Over(source=source, body=body):
            return (source, body)
    return ()


def keys_of(one: Expression, bound: frozenset[str] = frozenset()) -> Iterator[Key]:
    """Yield the keys of the store that an expression reads; items of `any` and its like are not."""
    if isinstance(one, Key):
        if one.name not in bound:
            yield one
    elif isinstance(one, Over):
        yield from keys_of(one.source, bound)
        yield from keys_of(one.body, bound | {one.item})
    else:
        for part in parts_of(one):
            yield from keys_of(part, bound)


def _bound(one: Expression, strength: int) -> str:
    if isinstance(one, Binary):
        own = BINDING[one.op]
    elif isinstance(one, Unary):
        own = NEGATION if one.op == "-" else BINDING["not"]
    else:
        own = _ATOM
    return str(one) if own >= strength else f"({one})"


def _is_path(one: Expression) -> bool:
    """Whether it is written within one pair of braces."""
    while isinstance(one, Field | Index):
        if isinstance(one, Index) and not _is_plain_index(one.index):
            return False
        one = one.of
    return isinstance(one, Key)


def _is_plain_index(index: Expression) -> bool:
    return isinstance(index, Number) and isinstance(index.value, int) and not index.unit


def _continued(of: Expression, tail: str) -> str:
    if _is_path(of):
        return f"{str(of)[:-1]}{tail}}}"
    return f"({of}){tail}" if isinstance(of, Number) else f"{_bound(of, _ATOM)}{tail}"
