"""What is known of a plugin before it is imported: its settings, what it needs, what it gives.

An entry point of the group `executive.settings.v1` names the settings class of a plugin:
`"surveying.mine" = "my_package.settings:MineSettings"`. If that module imports no algorithm, a
mission is read and checked without one. A plugin without such an entry point is imported for it.
"""

import inspect
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from executive.config import Settings
from executive.interfaces.facilities import FACILITIES
from executive.interfaces.plugin import Plugin
from executive.machine.machine import Machine


@dataclass(frozen=True, slots=True)
class Refusal:
    """A setting that cannot work on this machine.

    Attributes:
        setting: The names that lead to it; empty for the plugin as a whole.
        message: What is wrong, and the cure.
    """

    setting: tuple[str | int, ...]
    message: str


class MachineSettings(Settings):
    """Settings of a plugin or of a leaf, some of which may not suit a machine."""

    def refusals(self, machine: Machine) -> Iterator[Refusal]:
        """Yield what cannot work with this machine, its sensors, and the files of this computer."""
        yield from ()


class PluginSettings(MachineSettings):
    """Settings of a plugin that say what it needs, so that it can be checked without an import."""

    # The constructor's parameters after `settings`. Behind a dot stands what the selected plugin of
    # that capability has to give: `robot.scene`.
    needs: ClassVar[tuple[str, ...]] = ()

    # What the plugin gives to others beside its interface: the names of FACILITIES.
    gives: ClassVar[tuple[str, ...]] = ()


@dataclass(frozen=True, slots=True)
class Declared:
    """What a plugin declares.

    Attributes:
        settings: Its settings class.
        needs: Capabilities and services that it is given, with facilities behind a dot.
        gives: Facilities that it gives to others.
    """

    settings: type[Settings]
    needs: tuple[str, ...] = ()
    gives: tuple[str, ...] = ()

    @property
    def dependencies(self) -> tuple[str, ...]:
        """Return the capabilities and services that it is given."""
        return tuple(need.partition(".")[0] for need in self.needs)


def declared_by_settings(settings: type[PluginSettings]) -> Declared:
    """Return what a settings class says of its plugin."""
    return Declared(settings, settings.needs, settings.gives)


def declared_by_class(plugin: type[Plugin]) -> Declared:
    """Return what the class of a plugin shows."""
    told = getattr(plugin.Settings, "needs", ())
    facilities = {need.partition(".")[0]: need for need in told}
    names = constructor_parameters(plugin)
    gives = tuple(name for name, interface in FACILITIES.items() if issubclass(plugin, interface))
    return Declared(plugin.Settings, tuple(facilities.get(name, name) for name in names), gives)


def constructor_parameters(plugin: type[Plugin]) -> tuple[str, ...]:
    """Return the names of a plugin's constructor parameters after `settings`."""
    return tuple(inspect.signature(plugin).parameters)[1:]
