"""A YAML document as values that know their place: scalars, lists and tables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from executive.tree.problem import Mark, shortened
from executive.tree.scalar import Plain


@dataclass(frozen=True, slots=True)
class Scalar:
    """A text, number, truth value or nothing.

    Attributes:
        value: What YAML reads.
        mark: Where it begins.
        written: A text with braces as it is written, so that each of its letters has a place.
    """

    value: Plain
    mark: Mark
    written: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class Broken:
    """A value that was refused when it was read; it is not reported again."""

    mark: Mark


@dataclass(frozen=True, slots=True)
class Listing:
    """A list."""

    items: tuple["Value", ...]
    mark: Mark


class TableEntry(NamedTuple):
    """A key's place, and its value."""

    key_mark: Mark
    value: "Value"


@dataclass(frozen=True, slots=True)
class Table:
    """A mapping with text keys, in the order of the file."""

    entries: Mapping[str, TableEntry]
    mark: Mark

    def get(self, key: str) -> "Value | None":
        """Return a key's value, or None if the key is absent."""
        return self.entries[key].value if key in self.entries else None


Value = Scalar | Broken | Listing | Table


def plain(value: Value) -> Any:
    """Return the value without places, as Python's own types; a broken one becomes None."""
    if isinstance(value, Table):
        return {key: plain(entry.value) for key, entry in value.entries.items()}
    if isinstance(value, Listing):
        return [plain(item) for item in value.items]
    return value.value if isinstance(value, Scalar) else None


def has_broken(value: Value) -> bool:
    """Whether a part was refused when it was read."""
    if isinstance(value, Table):
        return any(has_broken(entry.value) for entry in value.entries.values())
    if isinstance(value, Listing):
        return any(has_broken(item) for item in value.items)
    return isinstance(value, Broken)


def describe(value: Value) -> str:
    """Say what a value is, for an error's sentence."""
    if isinstance(value, Table):
        return "a mapping"
    if isinstance(value, Listing):
        return "a list"
    if isinstance(value, Broken):
        return "something unreadable"
    if isinstance(value.value, bool):
        return str(value.value).lower()
    return "nothing" if value.value is None else shortened(repr(value.value), 60)


def merged(base: Value, over: Value) -> Value:
    """Merge two values: tables key by key, anything else is replaced; places are kept."""
    if not isinstance(base, Table) or not isinstance(over, Table):
        return over
    entries = dict(base.entries)
    for key, entry in over.entries.items():
        known = entries.get(key)
        entries[key] = (
            TableEntry(entry.key_mark, merged(known.value, entry.value)) if known else entry
        )
    return Table(entries, over.mark)


def without(table: Table, keys: Sequence[str]) -> Table:
    """Return the table without some keys."""
    return Table(
        {key: entry for key, entry in table.entries.items() if key not in keys}, table.mark
    )
