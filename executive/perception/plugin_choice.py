"""Perception plugins by name, with their default settings and what they need."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from executive import registry
from executive.mission.assembly import assemble, needed_for
from executive.tree.language import Selection

_MODEL = "m545"  # assembling wants a machine; perception on files looks at none
_CHOICES = {"segmentation": "ground_and_clusters", "alignment": "gicp", "registration": "segment_shot"}


@contextmanager
def chosen(capability: str, name: str | None = None) -> Iterator[Any]:
    """Give the started plugin of a capability, by its name or the default one.

    Raises:
        UnknownPluginError: If none of that name is installed.
    """
    names = _CHOICES | ({capability: name} if name else {})
    selections = {
        wanted: (Selection(plugin, registry.settings_of(wanted, plugin)()),) for wanted, plugin in names.items()
    }
    assembly = assemble(needed_for(selections, capability), _MODEL, 0)
    assembly.start()
    try:
        yield assembly.plugins[capability]
    finally:
        assembly.close()
