"""The messages that the page on troubleshooting quotes are those of the code."""

import ast
import re
from pathlib import Path

import pytest

from executive.events.mission import Fault

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "how-to" / "troubleshooting.md").read_text(encoding="utf-8")
EVENTS = (ROOT / "docs" / "journal_events.md").read_text(encoding="utf-8")
KINDS = set(re.findall(r"^### (\w+)$", EVENTS, re.M))
QUOTED = [
    message
    for row in re.findall(r"^\| (.*?) \| ", PAGE, re.M)
    for message in re.findall(r"`([^`]*)`", row)
    if len(message.split()) > 2 and not message.startswith(("--", "executive "))
]


def texts() -> list[str]:
    """Return the text constants of the code and the Makefile; `\\0` for each inserted value."""
    found = [(ROOT / "Makefile").read_text(encoding="utf-8")]
    for folder in ("executive", "plugins"):
        for path in (ROOT / folder).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.JoinedStr):
                    found.append("".join(map(_part, node.values)))
                elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                    found.append(node.value)
    return found


def _part(node: ast.expr) -> str:
    return str(node.value) if isinstance(node, ast.Constant) else "\0"


@pytest.fixture(scope="module")
def code() -> str:
    return "\n".join(texts())


def test_there_are_messages() -> None:
    assert len(QUOTED) > 12


@pytest.mark.parametrize("message", QUOTED)
def test_a_message_of_the_page_is_in_the_code(message: str, code: str) -> None:
    """Each stretch of words between inserted values, in capitals on the page, is in the code."""
    for stretch in re.split(r"'?\b[A-Z]{3,}(?::[A-Z]+)?\b'?|…|robot\.yaml|\b\d+\b", message):
        words = stretch.strip(" '().,:;")
        if len(words.split()) > 2:
            assert words in code, words


def test_the_message_of_a_fault_is_put_together_as_the_page_says() -> None:
    fault = Fault("CAPABILITY plugin 'NAME'", "", "", "VERB", "", "EXCEPTION", "FILE:LINE", "")
    assert f"`{fault.summary}`" in PAGE


@pytest.mark.parametrize("page", sorted((ROOT / "docs").rglob("*.md")), ids=lambda page: page.stem)
def test_an_event_that_a_page_names_is_one_of_the_journal(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    named = re.findall(r"journal's (?:last )?(?:events? )?`(\w+)`|`(\w+)` events?\b", text)
    named += re.findall(r"\b[Ee]vents? `(\w+)`()", text)
    assert {one or other for one, other in named} <= KINDS
