"""The words of an expression: numbers, names, texts, signs; each with its offset."""

import re
from typing import NamedTuple

_PATTERN = re.compile(
    r"(?P<space>\s+)"
    r"|(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<text>'[^']*'|\"[^\"]*\")"
    r"|(?P<sign><=|>=|==|!=|[-+*/<>()\[\]{}.,:])",
    re.ASCII,
)
_CURES = {
    "=": "compare with '=='",
    "&": "write 'and'",
    "|": "write 'or'",
    "!": "write 'not'",
    "'": "the quote is not closed",
    '"': "the quote is not closed",
    "%": "the remainder is not part of the language",
    "^": "powers are not part of the language",
}


class ExpressionError(ValueError):
    """A mistake in an expression; `at` is its offset in the text."""

    def __init__(self, at: int, message: str) -> None:
        super().__init__(message)
        self.at = at


class Token(NamedTuple):
    """A word: its kind (`number`, `name`, `text`, `sign`, `end`), its letters, its offset."""

    kind: str
    letters: str
    at: int

    @property
    def end(self) -> int:
        """Return the offset behind it."""
        return self.at + len(self.letters)


def tokens(text: str, start: int = 0) -> list[Token]:
    """Return the words of a text, and the end.

    Raises:
        ExpressionError: At a character that cannot stand there.
    """
    found = []
    at = start
    for match in _PATTERN.finditer(text, start):
        if match.start() != at:
            break
        at = match.end()
        kind = match.lastgroup or ""
        if kind != "space":
            found.append(Token(kind, match.group(), match.start()))
    if at < len(text):
        letter = text[at]
        cure = _CURES.get(letter, "quote texts, and put keys in braces")
        raise ExpressionError(at, f"'{letter}' cannot stand here; {cure}")
    found.append(Token("end", "", len(text)))
    return found
