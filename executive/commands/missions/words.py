"""`executive words`: the words of the mission language."""

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from executive.commands.console import answer, say
from executive.commands.options import JsonOption

if TYPE_CHECKING:
    from executive.tree.words.word import Word

_TITLES = {
    "node": "Nodes",
    "modifier": "Modifiers, outermost first",
    "action": "Actions (run:)",
    "check": "Checks (check:, or in a condition)",
}
_WIDTH = 78
_SENTENCE_END = re.compile(r"(?<!\bal)\. ")  # not that of "et al."


def words(
    name: Annotated[
        str | None, typer.Argument(help="A node, a modifier or a leaf; all by default.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """List the words of the mission language.

    With a name, show that word with its ports, settings and an example.

    Example: executive words ScanSwing
    """
    from executive.tree.words.vocabulary import vocabulary

    known = vocabulary()
    if name is not None:
        word = known.word(name)
        answer(word.as_dict()) if as_json else print("\n".join(_described(word)))
        return
    for broken, reason in known.broken.items():
        say(f"warning: the leaf '{broken}' is left out: {reason}")
    if as_json:
        answer([word.as_dict() for word in known.words.values()])
        return
    print("\n".join(_listed(list(known.words.values()))))


def _listed(all_words: Sequence["Word"]) -> Iterator[str]:
    for kind, title in _TITLES.items():
        yield f"{title}:"
        for word in (one for one in all_words if one.kind == kind):
            yield f"  {word.name:22} {_shortened(word.summary)}"
        yield ""
    yield "executive words NAME shows one of them."


def _shortened(text: str) -> str:
    first = _SENTENCE_END.split(text, maxsplit=1)[0].rstrip(".")
    return first if len(first) <= _WIDTH else f"{first[: _WIDTH - 1].rpartition(' ')[0]} …"


def _described(word: "Word") -> Iterator[str]:
    yield f"{word.name}: {word.kind}, from {word.package}"
    yield f"  {word.summary}"
    if word.kind in ("node", "modifier"):
        yield f"  written as: {', '.join(word.form)}"
    if word.needs:
        yield f"  needs plugins for: {', '.join(word.needs)}"
    if word.claims:
        yield f"  drives: {', '.join(word.claims)}"
    yield from _ports("in", word)
    yield from _ports("out", word)
    for one in word.settings:
        kind = f"{one.type} [{one.unit}]" if one.unit else one.type
        bounds = f" ({one.bounds})" if one.bounds else ""
        default = f"default {one.default}" if one.default else "may be left out"
        default = "required" if one.default == "required" else default
        yield f"  with {one.name}: {kind}, {default}{bounds}"
        yield f"       {one.meaning}"
    yield "  example:"
    yield from (f"    {line}" for line in word.example.splitlines())


def _ports(side: str, word: "Word") -> Iterator[str]:
    for port in word.inputs if side == "in" else word.outputs:
        may_miss = ", may be missing" if port.optional else ""
        yield f"  {side:4} {port.name}: {port.type}{may_miss}"
        yield f"       {port.meaning}"
