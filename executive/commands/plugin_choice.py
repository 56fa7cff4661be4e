"""Plugins for clouds by name, with their default settings and what they need."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from executive import registry
from executive.mission.assembly import assemble
from executive.tree.language import Selection

_MODEL = "m545"  # assembling wants a machine; perception on files looks at none
_CHOICES = {
    "segmentation": "ground_and_clusters",
    "alignment": "gicp",
    "registration": "segment_shot",
    "motion": "hermite",
    "grasping": "sampled_cnn",
    "viewing": "rerun",
}


@contextmanager
def chosen(capability: str, name: str | None = None, model: str = _MODEL) -> Iterator[Any]:
    """Give the started plugin of a capability, by its name or the default one, for a machine.

    Raises:
        UnknownPluginError: If none of that name is installed.
    """
    names = _CHOICES | ({capability: name} if name else {})
    assembly = assemble(_selections(capability, names), model, 0)
    assembly.start()
    try:
        yield assembly.plugins[capability]
    finally:
        assembly.close()


def _selections(capability: str, names: Mapping[str, str]) -> dict[str, tuple[Selection, ...]]:
    """Select a plugin and what it needs, and nothing more: the others are not even imported."""
    found: dict[str, tuple[Selection, ...]] = {}
    wanted = [capability]
    while wanted:
        one = wanted.pop()
        if one in names and one not in found:
            plugin = registry.load(one, names[one])
            found[one] = (Selection(names[one], plugin.Settings()),)
            wanted.extend(registry.dependencies_of(plugin))
    return found
