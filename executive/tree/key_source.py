"""Where a value comes from: a key, an expression on keys, a text with keys, the file itself."""

from dataclasses import dataclass, field
from typing import Any

from executive.tree.expressions.syntax import Expression
from executive.tree.place import Place
from executive.tree.problem import Mark


@dataclass(frozen=True, slots=True)
class Ref:
    """A reference to a key of the store, `"{key}"`; not listed, a port uses its own name."""

    key: str
    mark: Mark
    is_listed: bool = True


@dataclass(frozen=True, slots=True)
class Computed:
    """An expression on keys of the store: `{stone.mass} > 0.8 t`."""

    expression: Expression
    place: Place = field(compare=False)

    @property
    def mark(self) -> Mark:
        return self.place.mark

    def __str__(self) -> str:
        return str(self.expression)


@dataclass(frozen=True, slots=True)
class Template:
    """A text with expressions in it: `Lift stone {stone.id}?`; each part is one or the other."""

    parts: tuple[str | Expression, ...]
    place: Place = field(compare=False)

    @property
    def mark(self) -> Mark:
        return self.place.mark

    def __str__(self) -> str:
        return self.place.value


@dataclass(frozen=True, slots=True)
class Literally:
    """A value written in the mission file itself."""

    value: Any


KeySource = Ref | Computed | Template  # what reads keys
Source = KeySource | Literally
