"""Markdown that several generated pages share."""

import inspect
from typing import Any

NOTE = "<!-- Written by docs/generate.py from the code. Do not edit. -->\n"


def first_line(thing: Any) -> str:
    """Return the first paragraph of the docstring of a class or module, in one line."""
    has_text = inspect.isclass(thing) or inspect.ismodule(thing)
    text = inspect.getdoc(thing) if has_text else None
    paragraph = (text or "").partition("\n\n")[0]
    return cell(" ".join(paragraph.split()))


def cell(text: str) -> str:
    """Return a text for a cell of a table."""
    return text.replace("|", "\\|")


def code(text: str) -> str:
    """Return a text as code; a dash for none."""
    return f"`{cell(text)}`" if text else "–"
