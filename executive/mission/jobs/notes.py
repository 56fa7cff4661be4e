"""What this process is in, noted for the supervisor in case the process never comes out of it."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from executive import registry
from executive.interfaces.plugin import Plugin
from executive.mission.jobs.call import Address
from executive.mission.jobs.stack import folder_of
from executive.supervision.beacon import beacon, note_of

_notes: dict[tuple[type[Plugin], str], bytes] = {}  # a note takes far longer than a short verb


def address_of(plugin: Plugin, verb: str) -> Address:
    """Return the address of a verb of a plugin, by the name under which it is installed."""
    name = registry.name_of(plugin.capability, type(plugin))
    return Address.of(plugin.capability, name, plugin, verb)


def activity_of(address: Address, plugin: Plugin) -> dict[str, str]:
    """Return what the supervisor tells of a verb that this process did not survive."""
    return {
        "component": address.component,
        "capability": address.capability,
        "name": address.name,
        "verb": address.verb,
        "place": address.place,
        "folder": folder_of(plugin),
    }


@contextmanager
def loop_in_verb(plugin: Plugin, verb: str) -> Iterator[None]:
    """Note, within this context, that the loop itself calls a verb, without a job."""
    note = _notes.get((type(plugin), verb))
    if note is None:
        note = note_of(activity_of(address_of(plugin, verb), plugin))
        _notes[type(plugin), verb] = note
    page = beacon()
    page.enter(note)
    try:
        yield
    finally:
        page.leave()


@contextmanager
def loop_in_leaf(node: str, leaf: str) -> Iterator[None]:
    """Note, within this context, a leaf's own code, and what it calls without a job."""
    page = beacon()
    page.enter(_note_of_leaf(node, leaf))
    try:
        yield
    finally:
        page.leave()


@cache
def _note_of_leaf(node: str, leaf: str) -> bytes:
    return note_of({"component": f"behaviour '{leaf}'", "name": leaf, "node": node})
