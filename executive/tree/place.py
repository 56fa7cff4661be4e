"""Where a letter of a scalar's value stands in the file."""

from dataclasses import dataclass

from executive.tree.problem import Mark

_ESCAPED = {"x": 2, "u": 4, "U": 8}  # hexadecimal digits behind a backslash


@dataclass(frozen=True, slots=True)
class Place:
    """A text of the file.

    Attributes:
        mark: Where its scalar begins, quote included.
        value: The text as YAML reads it.
        written: The text as it is written, with quotes, escapes and line breaks; empty if it is
            not known, and then every letter is placed at the scalar's beginning.
    """

    mark: Mark
    value: str
    written: str = ""

    def at(self, offset: int) -> Mark:
        """Return the place of a letter of the value; an offset behind the end is the end's."""
        at = self._start()
        for index, letter in enumerate(self.value):
            at = self._skipped(at, letter)
            if index >= offset:
                break
            at += self._width(at, letter)
        return self._mark(at) if self.written else self.mark

    def _start(self) -> int:
        first = self.written[:1]
        if first in ("|", ">"):
            return self.written.find("\n") + 1
        return 1 if first in ("'", '"') else 0

    def _skipped(self, at: int, letter: str) -> int:
        """Skip the indentation and the line breaks that YAML folds."""
        rest = self.written[at:]
        if letter.isspace() or rest[:1] == letter:
            return at
        return at + len(rest) - len(rest.lstrip())

    def _width(self, at: int, letter: str) -> int:
        """Return how many letters of the file make one letter of the value."""
        rest, quote = self.written[at:], self.written[:1]
        if quote == '"' and rest[:1] == "\\":
            return 2 + _ESCAPED.get(rest[1:2], 0)
        if quote == "'" and rest[:2] == "''":
            return 2
        if letter.isspace() and rest[:1] != letter:
            return len(rest) - len(rest.lstrip())
        return 1

    def _mark(self, at: int) -> Mark:
        before = self.written[:at]
        lines = before.count("\n")
        if not lines:
            return Mark(self.mark.file, self.mark.line, self.mark.column + at)
        return Mark(self.mark.file, self.mark.line + lines, at - before.rfind("\n"))
