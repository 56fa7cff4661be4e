"""Plugins from a mission's selections: made in the order of the data, each given what its constructor names."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from executive import registry
from executive.config import Settings
from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from robot_models.machine import Machine, load_machine

# Several plugins of these capabilities may run side by side; a list is what the mission gets.
PLURAL = ("monitoring",)


@dataclass(frozen=True, slots=True)
class Selection:
    """One plugin chosen by a mission, with its checked settings; picklable, so that a worker can make its own copy."""

    capability: str
    name: str
    settings: Settings


@dataclass(frozen=True, slots=True)
class Assembly:
    """The plugins of one mission by capability; plural capabilities hold a tuple."""

    machine: Machine
    plugins: Mapping[str, Any]
    order: tuple[Plugin, ...]

    def start(self) -> None:
        """Start all plugins in the order of the data."""
        for plugin in self.order:
            plugin.start()

    def close(self) -> None:
        """Close all plugins in the reverse order, all of them, and then raise the first error of any."""
        errors: list[Exception] = []
        for plugin in reversed(self.order):
            try:
                plugin.close()
            except (OSError, RuntimeError, ValueError) as error:
                errors.append(error)
        if errors:
            raise errors[0]


def assemble(selections: Sequence[Selection], model: str, seed: int) -> Assembly:
    """Make the selected plugins, dependencies first.

    Raises:
        ConfigError: If a plugin needs a capability that is not selected, or plugins need each other in a circle.
    """
    machine = load_machine(model)
    made: dict[str, Any] = {}
    order: list[Plugin] = []
    by_capability = {name: [s for s in selections if s.capability == name] for name in registry.CAPABILITIES}

    def make(capability: str, path: tuple[str, ...]) -> Any:
        if capability in made:
            return made[capability]
        if capability in path:
            raise ConfigError(f"plugins need each other in a circle: {' → '.join((*path, capability))}")
        if not by_capability.get(capability):
            raise ConfigError(f"the {path[-1]} plugin needs a {capability} plugin, and the mission selects none")
        plugins = tuple(make_one(chosen, path) for chosen in by_capability[capability])
        made[capability] = plugins if capability in PLURAL else plugins[0]
        return made[capability]

    def make_one(chosen: Selection, path: tuple[str, ...]) -> Plugin:
        plugin_class = registry.load(chosen.capability, chosen.name)
        services = {"machine": machine, "rng": _generator(seed, f"{chosen.capability}/{chosen.name}")}
        given = {
            name: services[name] if name in services else make(name, (*path, chosen.capability))
            for name in registry.dependencies_of(plugin_class)
        }
        plugin: Plugin = plugin_class(chosen.settings, **given)
        order.append(plugin)
        return plugin

    for capability in registry.CAPABILITIES:
        if by_capability[capability]:
            make(capability, ())
    return Assembly(machine, made, tuple(order))


def needed_for(selections: Sequence[Selection], capability: str) -> tuple[Selection, ...]:
    """Return the selections that a copy of one capability's plugin needs, itself included."""
    wanted, reached = [capability], set[str]()
    while wanted:
        name = wanted.pop()
        if name in reached:
            continue
        reached.add(name)
        for chosen in selections:
            if chosen.capability == name:
                dependencies = registry.dependencies_of(registry.load(name, chosen.name))
                wanted.extend(d for d in dependencies if d in registry.CAPABILITIES)
    return tuple(s for s in selections if s.capability in reached)


def _generator(seed: int, stream: str) -> np.random.Generator:
    return seeded(seed, stream, 0)


def seeded(seed: int, stream: str, number: int) -> np.random.Generator:
    """Return the generator of a named stream: independent of every other name and number, equal on every run."""
    return np.random.default_rng([seed, number, *stream.encode()])
