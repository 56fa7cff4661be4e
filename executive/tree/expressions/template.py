"""Texts with keys in braces: `Lift stone {stone.id}?`."""

from executive.leaf.store import Store
from executive.tree.expressions.evaluation import evaluate
from executive.tree.expressions.functions import as_text
from executive.tree.expressions.parser import parse_path
from executive.tree.expressions.syntax import Expression
from executive.tree.expressions.tokens import ExpressionError

Parts = tuple[str | Expression, ...]


def split_template(text: str) -> Parts:
    """Return the plain parts of a text and the keys between them; `{{` and `}}` are braces.

    Raises:
        ExpressionError: If a brace is not closed, or what it holds is no key.
    """
    parts: list[str | Expression] = []
    plain, at = "", 0
    while at < len(text):
        letter = text[at]
        if letter in "{}" and text[at + 1 : at + 2] == letter:
            plain, at = plain + letter, at + 2
        elif letter == "{":
            path, after = parse_path(text, at)
            parts += [plain, path] if plain else [path]
            plain, at = "", after
        elif letter == "}":
            raise ExpressionError(at, "no brace is open here; a brace as text is written '}}'")
        else:
            plain, at = plain + letter, at + 1
    return (*parts, plain) if plain or not parts else tuple(parts)


def filled(parts: Parts, store: Store) -> str:
    """Return the text with the values of its keys.

    Raises:
        ConfigError: If a key was never written.
    """
    return "".join(
        part if isinstance(part, str) else as_text(evaluate(part, store)) for part in parts
    )
