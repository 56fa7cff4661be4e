"""The page of the events of the journal."""

import dataclasses
import inspect
import types
import typing
from collections.abc import Iterator

from executive.events.event import Event
from executive.journal import EVENT_MODULES
from executive.leaf.port import section
from executive.tree.words.field_words import type_words
from generators.markdown import NOTE, cell, first_line

EVENTS = """\
# Events of the journal

The kinds of events that the executive and its leaves write, with the fields of `payload`. In
Python, `executive.journal.read_journal` gives each back as its class of `executive/events`.
Packages may add kinds of their own; those are read back as `UnknownEvent` where the package is not
installed.
How to read a run: [read a run](how-to/read_a_run.md).
"""


def events_page() -> str:
    """Return the page of all events of the journal."""
    parts = [EVENTS]
    for module in EVENT_MODULES:
        parts += [
            f"## {module.__name__.rpartition('.')[2].capitalize()}\n",
            f"{first_line(module)}\n",
        ]
        parts += [line for event in _events_of(module) for line in _event(event)]
    return "\n".join([NOTE, *parts])


def _events_of(module: types.ModuleType) -> list[type[Event]]:
    return [
        one
        for one in vars(module).values()
        if inspect.isclass(one) and issubclass(one, Event) and one.__module__ == module.__name__
    ]


def _event(event: type[Event]) -> Iterator[str]:
    yield f"### {event.kind}\n"
    yield f"{first_line(event)}\n"
    meanings = section(event.__doc__, "Attributes")
    kinds = typing.get_type_hints(event)
    rows = [(one.name, kinds[one.name]) for one in dataclasses.fields(event)]
    if rows and not meanings:
        yield f"Fields: {', '.join(f'`{name}` ({type_words(kind)})' for name, kind in rows)}.\n"
    elif rows:
        yield "| field | type | meaning |"
        yield "|---|---|---|"
        for name, kind in rows:
            yield f"| `{name}` | {type_words(kind)} | {cell(meanings.get(name, ''))} |"
        yield ""
    for name, kind in rows:
        for part in (kind, *typing.get_args(kind)):
            if dataclasses.is_dataclass(part):
                fields = ", ".join(f"`{one.name}`" for one in dataclasses.fields(part))
                yield f"`{name}` holds {fields}. {first_line(part)}\n"
