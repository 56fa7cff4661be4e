"""Mistakes in a mission, each with its place; collected, so that all are reported at once."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

from executive.errors import ConfigError

_FILES = (".yaml", ".yml")
_LONGEST = 1000  # characters of a message; what was typed may be a whole book


class Mark(NamedTuple):
    """A place in a file, counted from 1; line 0 means the file or option as a whole."""

    file: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}" if self.line else self.file


@dataclass(frozen=True, order=True, slots=True)
class Problem:
    """One mistake, or one thing worth a second look."""

    mark: Mark
    message: str
    severity: str = "error"

    def __str__(self) -> str:
        return f"{self.mark}: {self.severity}: {self.message}"


def shortened(text: str, longest: int) -> str:
    """Return a text cut to a length, with an ellipsis where it was cut."""
    return text if len(text) <= longest else text[: longest - 1] + "…"


def one_line(text: str) -> str:
    """Return a text with line breaks and what cannot be printed written as escapes."""
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in text)


class MissionFileError(ConfigError):
    """A mission has mistakes; `problems` lists all of them in the order of their places."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(sorted(set(problems)))
        super().__init__("\n".join(str(problem) for problem in self.problems))


class Problems:
    """Collects mistakes while a mission is read."""

    def __init__(self) -> None:
        self._found: list[Problem] = []
        # Whether a file could not be read: what seems to be missing may stand there.
        self.is_partial = False

    def error(self, mark: Mark, message: str) -> None:
        """Take note of a mistake."""
        self._found.append(Problem(mark, shortened(one_line(message), _LONGEST)))

    def warning(self, mark: Mark, message: str) -> None:
        """Take note of something that works but was hardly meant."""
        self._found.append(Problem(mark, shortened(one_line(message), _LONGEST), "warning"))

    def all(self) -> tuple[Problem, ...]:
        """Return everything, in the order of the places."""
        return tuple(sorted(set(self._found)))

    def warnings(self) -> tuple[Problem, ...]:
        """Return the warnings in the order of their places."""
        return tuple(p for p in self.all() if p.severity == "warning")

    def tell_of(self, mission: str) -> None:
        """Name the mission, too, if all mistakes are in other files that it uses.

        Args:
            mission: The mission's file, as marks name it.
        """
        files = sorted({p.mark.file for p in self._found if p.severity == "error"})
        if files and mission not in files and all(one.endswith(_FILES) for one in files):
            self.error(Mark(mission), f"it uses what has mistakes: {', '.join(files)}")

    def raise_errors(self) -> None:
        """Raise all mistakes, if there are any.

        Raises:
            MissionFileError: With every mistake so far; warnings that may follow from them are left
                out.
        """
        if any(p.severity == "error" for p in self._found):
            raise MissionFileError(p for p in self._found if p.severity == "error")
