"""Read one YAML document: libyaml's events to values with places; what could surprise is refused.

Anchors, aliases, tags, merge keys, duplicate keys and several documents are refused; scalars follow
YAML 1.2's core schema. The events are taken, not `yaml.compose`: its nodes hide aliases, and it
recurses, so that a deeply nested file would end the process.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from executive.plain_yaml import MAX_DEPTH, TOO_DEEP, too_deep_in_line
from executive.tree.problem import Mark, Problems
from executive.tree.scalar import SurpriseError, resolve
from executive.tree.value import Broken, Listing, Scalar, Table, TableEntry, Value

_MAX_BYTES = 10_000_000
_FIRST = {"structure": "structure: wall", "machine": "name: NAME"}  # files without a version
_UNPRINTABLE = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

# Messages of libyaml, and what a reader who does not know its grammar is shown instead.
_CURES = (
    (
        "cannot start any token",
        "this character cannot stand here; indent with spaces, never tabs, and quote special text",
    ),
    (
        "mapping values are not allowed",
        "a ':' is not allowed here; quote the text, or check the indentation",
    ),
    (
        "could not find expected ':'",
        "this line is neither 'key: value' nor a '- item'; check the indentation",
    ),
    (
        "did not find expected '-' indicator",
        "this does not line up with the list's other '- item' lines",
    ),
    ("did not find expected key", "this does not line up with the mapping's other keys"),
    ("did not find expected ',' or '}'", "a '{' is not closed, or a ',' is missing"),
    ("did not find expected ',' or ']'", "a '[' is not closed, or a ',' is missing"),
    ("found unexpected end of stream", "a quote is not closed"),
    ("found undefined tag handle", "tags (!) are not part of the mission language; quote the text"),
)


@dataclass(slots=True)
class _Open:
    """A list or table whose end has not come yet."""

    mark: Mark
    is_table: bool
    items: list[Value] = field(default_factory=list)
    entries: dict[str, TableEntry] = field(default_factory=dict)
    key: tuple[str, Mark] | None = None


def read_file(path: Path, name: str, problems: Problems, kind: str = "mission") -> Value | None:
    """Read a file, called `name` in messages; return None if it cannot be parsed.

    Args:
        path: The file.
        name: What messages call it.
        problems: Takes the mistakes.
        kind: What the file describes: a mission, a campaign, a structure.
    """
    try:
        with path.open("rb") as file:
            data = file.read(_MAX_BYTES + 1)
    except IsADirectoryError:
        problems.error(Mark(name), f"this is a folder, not a {kind} file")
        return None
    except (OSError, ValueError) as error:
        problems.error(Mark(name), f"cannot be read: {getattr(error, 'strerror', None) or error}")
        return None
    if len(data) > _MAX_BYTES:
        problems.error(Mark(name), f"more than {_MAX_BYTES:,} bytes: this is no {kind} file")
        return None
    return read_bytes(data, name, problems, kind)


def read_bytes(data: bytes, name: str, problems: Problems, kind: str = "mission") -> Value | None:
    """Read a document from bytes."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8", "replace")
        problems.error(
            _mark_after(name, before),
            f"not UTF-8 text (byte 0x{data[error.start]:02x}); save it as UTF-8",
        )
        return None
    return read_text(text, name, problems, kind)


def read_text(text: str, name: str, problems: Problems, kind: str = "mission") -> Value | None:
    """Read a document from text."""
    odd = _UNPRINTABLE.search(text)
    if odd:
        mark = _mark_after(name, text[: odd.start()])
        problems.error(
            mark,
            f"a control character (U+{ord(odd.group()):04X}) does not belong into a {kind} file",
        )
        return None
    try:
        document = _Reader(name, problems, text).read(yaml.parse(text, Loader=yaml.CSafeLoader))
    except yaml.MarkedYAMLError as error:
        place = error.problem_mark or error.context_mark
        mark = Mark(name, place.line + 1, place.column + 1) if place else Mark(name)
        is_too_deep = too_deep_in_line(error) is not None
        words = TOO_DEEP if is_too_deep else _words(error.problem or "", error.context or "")
        problems.error(mark, words)
        return None
    except yaml.YAMLError as error:
        problems.error(Mark(name), f"not YAML: {' '.join(str(error).split())}")
        return None
    if document is None:
        first = _FIRST.get(kind, "api: 1")
        problems.error(Mark(name, 1, 1), f"the file is empty; a {kind} begins with '{first}'")
    return document


class _Reader:
    def __init__(self, name: str, problems: Problems, text: str) -> None:
        self._name = name
        self._text = text
        self._problems = problems
        self._open: list[_Open] = []
        self._document: Value | None = None
        self._documents = 0

    def read(self, events: Iterator[Any]) -> Value | None:
        for event in events:
            if isinstance(event, yaml.ScalarEvent):  # first, since most are
                self._scalar(event)
            elif isinstance(event, yaml.DocumentStartEvent):
                self._documents += 1
                if self._documents > 1:
                    self._problems.error(
                        self._mark(event), "a second document begins here; a file holds one"
                    )
                    break
            elif isinstance(event, yaml.CollectionStartEvent):
                if len(self._open) >= MAX_DEPTH:
                    self._problems.error(self._mark(event), TOO_DEEP)
                    return Broken(self._mark(event))
                self._refuse_extras(event)
                self._open.append(
                    _Open(self._mark(event), isinstance(event, yaml.MappingStartEvent))
                )
            elif isinstance(event, yaml.CollectionEndEvent):
                done = self._open.pop()
                self._add(
                    Table(done.entries, done.mark)
                    if done.is_table
                    else Listing(tuple(done.items), done.mark)
                )
            elif isinstance(event, yaml.AliasEvent):
                mark = self._mark(event)
                self._problems.error(
                    mark,
                    f"aliases (*{event.anchor}) are refused; write the value out, or use a subtree",
                )
                self._add(Broken(mark))
        return self._document

    def _scalar(self, event: Any) -> None:
        mark = self._mark(event)
        parent = self._open[-1] if self._open else None
        if (event.anchor is not None or event.tag is not None) and self._refuse_extras(event):
            self._add(Broken(mark))
            return
        odd = _UNPRINTABLE.search(event.value) if event.style == '"' else None
        if odd:  # written as an escape such as "\0"
            self._problems.error(
                mark, f"a control character (U+{ord(odd.group()):04X}) does not belong into a text"
            )
            self._add(Broken(mark))
            return
        if parent is not None and parent.is_table and parent.key is None:
            parent.key = (event.value, mark)
            return
        if not event.implicit[0]:  # quoted: text, whatever it looks like
            self._add(Scalar(event.value, mark, self._written(event)))
            return
        try:
            self._add(Scalar(resolve(event.value), mark, self._written(event)))
        except SurpriseError as error:
            self._problems.error(mark, str(error))
            self._add(Broken(mark))

    def _written(self, event: Any) -> str:
        """Return a text with braces as the file has it."""
        if "{" not in event.value:
            return ""
        written: str = self._text[event.start_mark.index : event.end_mark.index]
        return written

    def _add(self, value: Value) -> None:
        if not self._open:
            self._document = value
            return
        parent = self._open[-1]
        if not parent.is_table:
            parent.items.append(value)
        elif parent.key is None:
            self._problems.error(value.mark, "a key is a word, not a list, mapping or alias")
            parent.key = (f"<unreadable {len(parent.entries)}>", value.mark)
        else:
            self._add_entry(parent, *parent.key, value)
            parent.key = None

    def _add_entry(self, parent: _Open, key: str, mark: Mark, value: Value) -> None:
        if key.startswith("<unreadable "):
            return
        if key == "<<":
            self._problems.error(
                mark, "merge keys (<<) are refused; use 'extends', or write the values out"
            )
        elif key in parent.entries:
            first = parent.entries[key].key_mark
            self._problems.error(
                mark, f"key '{key}' is given twice; the first is at line {first.line}"
            )
        else:
            parent.entries[key] = TableEntry(mark, value)

    def _refuse_extras(self, event: Any) -> bool:
        """Note an anchor or a tag; a tag leaves no value to go on with."""
        if event.anchor is None and event.tag is None:
            return False
        if event.anchor is not None:
            self._problems.error(
                self._mark(event),
                f"anchors (&{event.anchor}) are refused; write the value out where it is used",
            )
        if event.tag is not None:
            self._problems.error(
                self._mark(event),
                f"tags ({event.tag}) are refused; the settings class decides the type",
            )
        return event.tag is not None

    def _mark(self, event: Any) -> Mark:
        start = event.start_mark
        return Mark(self._name, start.line + 1, start.column + 1)


def _words(problem: str, context: str) -> str:
    for theirs, ours in _CURES:
        if theirs in problem:
            return ours
    return f"not YAML: {problem}{f' {context}' if context else ''}"


def _mark_after(name: str, before: str) -> Mark:
    return Mark(name, before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1)
