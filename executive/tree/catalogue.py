"""The plugins and behaviours that a mission can use: the installed ones, or a table of them."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any

from executive import registry
from executive.errors import ConfigError, UnknownPluginError, did_you_mean
from executive.interfaces.declaration import Declared, declared_by_class
from executive.interfaces.plugin import Plugin
from executive.leaf.action import Leaf

REQUIRED = ("robot", "estimation")  # what the loop itself calls
SERVICES = frozenset({"machine", "rng"})  # what a plugin's constructor is given without a selection


class Catalogue(ABC):
    """Names, and the classes behind them; a class is imported when it is used."""

    @abstractmethod
    def plugin_names(self, capability: str) -> tuple[str, ...]:
        """List the plugins of a capability."""

    @abstractmethod
    def behaviour_names(self) -> tuple[str, ...]:
        """List the behaviours."""

    @abstractmethod
    def _load(self, capability: str, name: str) -> Any: ...

    def capabilities(self) -> tuple[str, ...]:
        """List the capabilities, in the order in which data flows."""
        return registry.capabilities()

    def plugin(self, capability: str, name: str) -> type[Plugin]:
        """Return a plugin's class.

        Raises:
            ConfigError: If there is none of that name, or it cannot be imported.
        """
        plugin: type[Plugin] = self._load(capability, name)
        if not issubclass(plugin, Plugin):
            raise ConfigError(f"{capability} plugin '{name}' ({plugin.__qualname__}) is no Plugin")
        return plugin

    def declared(self, capability: str, name: str) -> Declared:
        """Return the settings class of a plugin, what it needs and what it gives.

        Raises:
            ConfigError: If there is none of that name, or it cannot be imported.
        """
        return declared_by_class(self.plugin(capability, name))

    def behaviour(self, name: str) -> type[Leaf[Any]]:
        """Return a behaviour's class.

        Raises:
            ConfigError: If there is none of that name, or it cannot be imported.
        """
        if name not in self.behaviour_names():
            raise ConfigError(f"no behaviour '{name}'{did_you_mean(name, self.behaviour_names())}")
        leaf: type[Leaf[Any]] = self._load(registry.BEHAVIOURS, name)
        if not issubclass(leaf, Leaf):
            raise ConfigError(
                f"behaviour '{name}' ({leaf.__qualname__}) is neither an Action nor a Condition"
            )
        return leaf

    def behaviours(self) -> Iterator[tuple[str, type[Leaf[Any]]]]:
        """Import all behaviours, those left out that cannot be imported; for rare messages."""
        for name in self.behaviour_names():
            with suppress(ConfigError):
                yield name, self.behaviour(name)


class InstalledCatalogue(Catalogue):
    """What the entry points announce."""

    def plugin_names(self, capability: str) -> tuple[str, ...]:
        return registry.names(capability)

    def behaviour_names(self) -> tuple[str, ...]:
        return self.plugin_names(registry.BEHAVIOURS)

    def declared(self, capability: str, name: str) -> Declared:
        return registry.declared(capability, name)

    def _load(self, capability: str, name: str) -> Any:
        return registry.load(capability, name)


class TableCatalogue(Catalogue):
    """A table of classes, for tests and for programs that bring their own."""

    def __init__(
        self,
        behaviours: Mapping[str, type[Leaf[Any]]],
        plugins: Mapping[str, Mapping[str, type[Plugin]]] | None = None,
    ) -> None:
        self._table: dict[str, Mapping[str, type]] = {
            **(plugins or {}),
            registry.BEHAVIOURS: behaviours,
        }

    def plugin_names(self, capability: str) -> tuple[str, ...]:
        return tuple(sorted(self._table.get(capability, {})))

    def behaviour_names(self) -> tuple[str, ...]:
        return self.plugin_names(registry.BEHAVIOURS)

    def _load(self, capability: str, name: str) -> Any:
        known = self._table.get(capability, {})
        if name not in known:
            raise UnknownPluginError(capability, name, known)
        return known[name]
