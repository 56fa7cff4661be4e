"""HTML that is escaped by construction: a text that is not `Markup` is data."""

import html
from collections.abc import Iterable, Sequence

_VOID = frozenset({"meta", "br", "hr"})


class Markup(str):
    """Text that is HTML already."""

    __slots__ = ()


def tag(name: str, /, *children: str, **attributes: str) -> Markup:
    """Return an element; children and attributes that are no `Markup` are escaped.

    Args:
        name: The element's name.
        children: Its content.
        attributes: Its attributes; a trailing underscore is cut off (`class_`), and others become
            hyphens (`aria_label`).
    """
    given = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{html.escape(value)}"'
        for key, value in attributes.items()
    )
    if name in _VOID:
        return Markup(f"<{name}{given}>")
    return Markup(f"<{name}{given}>{joined(children)}</{name}>")


def joined(parts: Iterable[str]) -> Markup:
    """Return parts one after another, each escaped unless it is `Markup`."""
    return Markup("".join(p if isinstance(p, Markup) else html.escape(p) for p in parts))


def paragraph(*children: str, class_: str = "") -> Markup:
    """Return a paragraph."""
    return tag("p", *children, class_=class_) if class_ else tag("p", *children)


def prose(text: str) -> Markup:
    """Return a text in which what stands between backticks is code."""
    parts = text.split("`")
    return joined(tag("code", part) if n % 2 else part for n, part in enumerate(parts))


def table(
    heads: Sequence[str], rows: Iterable[Sequence[str]], numbers: Sequence[int] = ()
) -> Markup:
    """Return a table that can be moved sideways where it is wider than the screen.

    Args:
        heads: Titles of the columns.
        rows: Cells.
        numbers: Columns that hold numbers and are aligned to the right.
    """
    right = set(numbers)

    def cell(name: str, column: int, text: str) -> Markup:
        return tag(name, text, class_="number") if column in right else tag(name, text)

    head = tag("tr", *(cell("th", column, text) for column, text in enumerate(heads)))
    body = (tag("tr", *(cell("td", c, text) for c, text in enumerate(row))) for row in rows)
    return tag(
        "div", tag("table", tag("thead", head), tag("tbody", *body)), class_="table", tabindex="0"
    )


def listing(items: Iterable[str]) -> Markup:
    """Return a bulleted list."""
    return tag("ul", *(tag("li", item) for item in items))


def pairs(items: Iterable[tuple[str, str]]) -> Markup:
    """Return terms with their explanations."""
    return tag("dl", *(joined((tag("dt", term), tag("dd", text))) for term, text in items))
