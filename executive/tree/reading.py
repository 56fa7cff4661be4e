"""Reads basic values: texts, numbers, durations, references, tables with known keys only."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from executive.config import parse_quantity
from executive.errors import did_you_mean
from executive.interfaces.declaration import MachineSettings
from executive.messages.region import Region
from executive.tree.catalogue import Catalogue
from executive.tree.expressions.parser import is_quantity, parse
from executive.tree.expressions.syntax import Key
from executive.tree.expressions.template import split_template
from executive.tree.expressions.tokens import ExpressionError
from executive.tree.key_source import Computed, Literally, Ref, Source, Template
from executive.tree.place import Place
from executive.tree.problem import Mark, Problems
from executive.tree.value import Broken, Listing, Scalar, Table, Value, describe, has_broken, plain

_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_REFERENCE = re.compile(r"\{([A-Za-z_][A-Za-z0-9_]*)\}")


@dataclass(frozen=True, slots=True)
class PlacedSettings:
    """Checked settings of a leaf, and the table of the file that gives them."""

    settings: MachineSettings
    table: Table


@dataclass(frozen=True, slots=True)
class Reading:
    """What reading a mission needs; each method notes a mistake and then returns None.

    Attributes:
        catalogue: What can be chosen.
        problems: Where mistakes are noted.
        instances: Names of plugins by capability, where a mission selects several by name.
    """

    catalogue: Catalogue
    problems: Problems
    instances: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    regions: Mapping[str, Region] = field(default_factory=dict)  # of the mission, by name
    placed: list[PlacedSettings] = field(default_factory=list)  # of leaves, for the machine's check

    def fail(self, value: Value, message: str) -> None:
        """Note a mistake, unless the value was refused already."""
        if not isinstance(value, Broken):
            self.problems.error(value.mark, message)

    def table(self, value: Value, what: str) -> Table | None:
        """Return a mapping."""
        if isinstance(value, Table):
            return value
        self.fail(value, f"{what} is a mapping, not {describe(value)}")
        return None

    def listing(self, value: Value, what: str) -> Listing | None:
        """Return a list that is not empty."""
        if not isinstance(value, Listing):
            self.fail(value, f"{what} takes a list, not {describe(value)}")
            return None
        if not value.items:
            self.fail(value, f"{what} takes a list of at least one item")
            return None
        return value

    def text(self, value: Value, what: str) -> str | None:
        """Return a text that is not empty."""
        if isinstance(value, Scalar) and isinstance(value.value, str) and value.value.strip():
            return value.value
        self.fail(value, f"{what} is a text, not {describe(value)}")
        return None

    def name(self, value: Value, what: str) -> str | None:
        """Return a word of letters, digits and underscores."""
        text = self.text(value, what)
        return text if text is None else self.checked_name(text, value.mark, what)

    def checked_name(self, text: str, mark: Mark, what: str) -> str | None:
        """Return the text if it is a word of letters, digits and underscores."""
        if _KEY.fullmatch(text):
            return text
        self.problems.error(mark, f"{what} is a word of letters, digits and _, not '{text}'")
        return None

    def whole(self, value: Value, what: str, least: int = 1) -> int | None:
        """Return a whole number."""
        got = value.value if isinstance(value, Scalar) else None
        if isinstance(got, int) and not isinstance(got, bool) and got >= least:
            return got
        self.fail(value, f"{what} is a whole number of at least {least}, not {describe(value)}")
        return None

    def truth(self, value: Value, what: str) -> bool | None:
        """Return true or false."""
        if isinstance(value, Scalar) and isinstance(value.value, bool):
            return value.value
        self.fail(value, f"{what} is true or false, not {describe(value)}")
        return None

    def seconds(self, value: Value, what: str, *, allow_zero: bool = False) -> float | None:
        """Return a duration [s]."""
        if not isinstance(value, Scalar) or value.value is None:
            self.fail(value, f"{what} is a duration such as 30 s, not {describe(value)}")
            return None
        try:
            duration_s = parse_quantity(value.value, "time")
        except ValueError as error:
            self.fail(value, f"{what}: {error}")
            return None
        if 0 < duration_s < float("inf") or (allow_zero and duration_s == 0):
            return duration_s
        least = "at least 0 s" if allow_zero else "more than 0 s"
        self.fail(value, f"{what} must be {least} and finite, got {describe(value)}")
        return None

    def reference(self, value: Value, what: str) -> Ref | None:
        """Return a reference to a key."""
        match = _REFERENCE.fullmatch(value.value) if is_text(value) else None  # type: ignore[union-attr, arg-type]
        if match:
            return Ref(match.group(1), value.mark)
        self.fail(
            value,
            f'{what} takes a reference such as "{{key}}", not {describe(value)}{_hint(value)}',
        )
        return None

    def source(self, value: Value, what: str) -> Source | None:
        """Return a reference, an expression, or the value itself if it is neither.

        A text with a brace is an expression, and so is a number with a unit.
        """
        if isinstance(value, Table):
            return self.reference(value, what)
        if is_text(value):
            text = str(value.value)  # type: ignore[union-attr]
            if "{" in text:
                return self.expression(value, what)
            if is_quantity(text):
                return Computed(parse(text), place_of(value))
        return None if has_broken(value) else Literally(plain(value))

    def expression(self, value: Value, what: str) -> Ref | Computed | None:
        """Return an expression; one that is only a key becomes a reference."""
        text = self.text(value, what)
        if text is None:
            return None
        place = place_of(value)
        try:
            expression = parse(text)
        except ExpressionError as error:
            self.problems.error(place.at(error.at), f"{what}: {error}")
            return None
        if isinstance(expression, Key):
            return Ref(expression.name, value.mark)
        return Computed(expression, place)

    def template(self, value: Value, what: str) -> Template | None:
        """Return a text with expressions in braces."""
        text = self.text(value, what)
        if text is None:
            return None
        place = place_of(value)
        try:
            return Template(split_template(text), place)
        except ExpressionError as error:
            self.problems.error(place.at(error.at), f"{what}: {error}")
            return None

    def known_keys(self, table: Table, allowed: Collection[str], what: str) -> None:
        """Note every key that is not allowed."""
        for key, entry in table.entries.items():
            if key not in allowed:
                self.problems.error(
                    entry.key_mark, f"{what} has no '{key}'{did_you_mean(key, allowed)}"
                )


def place_of(value: Value) -> Place:
    """Return where the letters of a text stand."""
    if isinstance(value, Scalar) and isinstance(value.value, str):
        return Place(value.mark, value.value, value.written)
    return Place(value.mark, "")


def is_text(value: Value) -> bool:
    """Whether a value is a text."""
    return isinstance(value, Scalar) and isinstance(value.value, str)


def _hint(value: Value) -> str:
    if isinstance(value, Table) and len(value.entries) == 1:
        key = next(iter(value.entries))
        return f'; write "{{{key}}}" in quotes, without them YAML reads a mapping'
    if is_text(value) and _KEY.fullmatch(value.value):  # type: ignore[union-attr, arg-type]
        return f'; did you mean "{{{value.value}}}"?'  # type: ignore[union-attr]
    return (
        "; a literal belongs under 'with:' or into a 'set:' before"
        if not isinstance(value, Table)
        else ""
    )
