"""A hook of MkDocs: links from a page to a source file become plain names in the site.

The pages are read in the repository as well, where such links work; the site holds no source files.
"""

import re
from typing import Any

_OUT_OF_DOCS = re.compile(
    r"\[([^\]]+)\]\((?:\.\./)+(?:executive|plugins|trees|robot_models|tests)[^)]*\)"
)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Replace links that leave docs/ by their text."""
    return _OUT_OF_DOCS.sub(r"\1", markdown)
