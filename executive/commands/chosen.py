"""A plugin for a command that runs no mission: made, started, and closed again."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TypeVar

from executive.interfaces.plugin import Plugin
from executive.mission.assembly import assemble, needed_for
from executive.tree.choices import Choices, Known

P = TypeVar("P", bound=Plugin)


@contextmanager
def chosen(
    interface: type[P],
    choices: Choices | None = None,
    model: str | None = None,
    known: Mapping[str, Known] | None = None,
) -> Iterator[P]:
    """Give the started plugin of an interface.

    Args:
        interface: The interface, such as Segmenter.
        choices: The command's plugins; the shipped defaults if None.
        model: Name or folder of the machine; the one of the shipped missions if None.
        known: Settings that the command knows itself, by capability.

    Raises:
        ConfigError: If a plugin or a setting is refused, or the plugin is switched off.
    """
    capability = interface.capability
    choices = choices or Choices((capability,))
    choices.name(capability)  # refuses a plugin that is switched off
    selections = needed_for(choices.selections(known), capability)
    assembly = assemble(selections, model or choices.model, 0)
    assembly.start()
    try:
        yield assembly.plugins[capability]
    finally:
        assembly.close()
