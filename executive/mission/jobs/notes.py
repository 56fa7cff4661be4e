"""What this process is in, noted for the supervisor in case the process never comes out of it."""

from collections.abc import Mapping
from functools import cache
from types import TracebackType

from executive import registry
from executive.interfaces.plugin import Plugin
from executive.mission.jobs.call import Address
from executive.mission.jobs.stack import folder_of
from executive.supervision.beacon import beacon, note_of


class Noted:
    """The context of what the loop's thread is in; it has no state, and may lie within itself.

    It is entered some hundred times a tick, and takes a microsecond.
    """

    __slots__ = ("_note",)

    def __init__(self, activity: Mapping[str, str]) -> None:
        self._note = note_of(activity)

    def __enter__(self) -> None:
        beacon().enter(self._note)

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _traceback: TracebackType | None,
    ) -> None:
        beacon().leave()


_verbs: dict[tuple[type[Plugin], str], Noted] = {}  # to make one takes longer than a short verb


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


def loop_in_verb(plugin: Plugin, verb: str) -> Noted:
    """Return the context of a verb that the loop itself calls, without a job."""
    found = _verbs.get((type(plugin), verb))
    if found is None:
        found = Noted(activity_of(address_of(plugin, verb), plugin))
        _verbs[type(plugin), verb] = found
    return found


@cache
def loop_in_leaf(node: str, leaf: str) -> Noted:
    """Return the context of a leaf's own code, and of what it calls without a job."""
    return Noted({"component": f"behaviour '{leaf}'", "name": leaf, "node": node})
