"""The page of all words of a mission file, and the tables of nodes on the page about trees."""

from collections.abc import Iterable, Iterator

from executive.config import UNITS
from executive.tree.words.vocabulary import vocabulary
from executive.tree.words.word import PortWord, Word
from generators.markdown import NOTE, cell, code

WORDS = """\
# Words of missions

Every word that a mission file may use, read from what is installed. How they are put together:
[write a tree](how-to/write_a_tree.md). The same in a terminal, with the leaves of other packages:
`executive words` and `executive words ScanSwing`. Plugins and their settings:
`executive plugins list` and `executive plugins show CAPABILITY NAME`.
"""
ACTIONS = """\
## Actions

`run:` these. They take time. A port that is not listed under `in:` or `out:` of the node is
connected to the key of its own name; `?` marks one that may be missing.
"""
CHECKS = """\
## Checks

`check:` these, or name them in a condition. They answer at once.
"""


def words_page() -> str:
    """Return the page of all words of a mission file."""
    words = shipped_words()
    parts = [
        WORDS,
        "## Kinds of nodes\n",
        *_nodes(of_kind(words, "node")),
        "## Modifiers\n",
        "They are applied in this order, the first outermost.\n",
        *_nodes(of_kind(words, "modifier")),
        "## Units\n",
        *_units(),
        ACTIONS,
        *(line for word in of_kind(words, "action") for line in _leaf(word)),
        CHECKS,
        *(line for word in of_kind(words, "check") for line in _leaf(word)),
    ]
    return "\n".join([NOTE, *parts])


def shipped_words() -> list[Word]:
    """Return the words that come with this package."""
    return [one for one in vocabulary().words.values() if one.package == "executive"]


def of_kind(words: Iterable[Word], kind: str) -> list[Word]:
    """Return the words of a kind."""
    return [one for one in words if one.kind == kind]


def table_of(words: Iterable[Word], title: str) -> str:
    """Return the table of nodes or modifiers, as the page about trees shows it."""
    rows = [f"| {title} | what it does |", "|---|---|"]
    for word in words:
        form = ", ".join(f"`{cell(part)}`" for part in word.form)
        rows.append(f"| {form} | {cell(word.summary)} |")
    return "\n".join(rows)


def _nodes(words: Iterable[Word]) -> Iterator[str]:
    for word in words:
        yield f"### {word.name}\n"
        yield f"{word.summary[0].upper()}{word.summary[1:]}.\n"
        if word.keys:
            yield f"Keys beside it: {', '.join(f'`{key}`' for key in word.keys)}.\n"
        yield f"```yaml\n{word.example}\n```\n"


def _units() -> Iterator[str]:
    yield "| quantity | units; a plain number is in the first |"
    yield "|---|---|"
    for dimension, units in UNITS.items():
        yield f"| {dimension} | {', '.join(f'`{unit}`' for unit in units)} |"
    yield ""


def _leaf(word: Word) -> Iterator[str]:
    yield f"### {word.name}\n"
    yield f"{cell(word.summary)}\n"
    if word.needs:
        yield f"Needs plugins for: {', '.join(word.needs)}.\n"
    if word.claims:
        yield f"Drives: {', '.join(word.claims)}.\n"
    yield f"```yaml\n{word.example}\n```\n"
    rows = [*_ports("in", word.inputs), *_ports("out", word.outputs), *_settings(word)]
    if rows:
        yield "| | name | type | default | meaning |"
        yield "|---|---|---|---|---|"
        yield from rows
        yield ""


def _ports(side: str, ports: Iterable[PortWord]) -> Iterator[str]:
    for port in ports:
        kind = f"{port.type}{'?' * port.optional}"
        yield f"| {side} | `{port.name}` | {code(kind)} | – | {cell(port.meaning)} |"


def _settings(word: Word) -> Iterator[str]:
    for one in word.settings:
        kind = f"{one.type} [{one.unit}]" if one.unit else one.type
        bounds = f", {one.bounds}" if one.bounds else ""
        default = one.default if one.default == "required" else code(one.default)
        yield f"| with | `{one.name}` | {cell(kind + bounds)} | {default} | {cell(one.meaning)} |"
