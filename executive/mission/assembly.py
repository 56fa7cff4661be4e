"""Makes the selected plugins in the order of the data, and gives each what it asks for."""

import logging
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from executive import registry
from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from executive.interfaces.robot import RobotSettings
from executive.machine.machine import Machine, load_machine
from executive.tree.instances import capability_of, chosen_key
from executive.tree.selection import Selection

# What a mission has chosen, by capability or `capability.name`; picklable, so that a worker can
# make its own copies.
Selections = Mapping[str, tuple[Selection, ...]]


@dataclass(frozen=True, slots=True)
class Assembly:
    """The plugins of one mission by capability; plural capabilities hold a tuple.

    Plugins with names stand under `capability.name`.
    """

    machine: Machine
    plugins: Mapping[str, Any]
    order: tuple[Plugin, ...]

    def start(self) -> None:
        """Start all plugins in the order of the data."""
        for plugin in self.order:
            plugin.start()

    def close(self) -> None:
        """Close all plugins in reverse order, and then raise the first error of any."""
        errors: list[Exception] = []
        for plugin in reversed(self.order):
            try:
                plugin.close()
            except Exception as error:  # the others are closed all the same
                errors.append(error)
        for other in errors[1:]:  # the first is raised; the log has them all
            logging.getLogger(__name__).error("a plugin failed while it was closed", exc_info=other)
        if errors:
            raise errors[0]


def assemble(selections: Selections, model: str, seed: int) -> Assembly:
    """Make the selected plugins, dependencies first, for the machine of a name or folder.

    Raises:
        ConfigError: If a plugin needs a capability that is not selected, or plugins need each other
            in a circle.
    """
    return assemble_for(machine_of(selections, model), selections, seed)


def assemble_for(machine: Machine, selections: Selections, seed: int) -> Assembly:
    """Make the selected plugins for a machine, as `machine_of` all selections of a mission is.

    Raises:
        ConfigError: As `assemble` does.
    """
    made: dict[str, Any] = {}
    order: list[Plugin] = []

    def make(key: str, path: tuple[str, ...]) -> Any:
        if key in made:
            return made[key]
        if key in path:
            raise ConfigError(f"plugins need each other in a circle: {' → '.join((*path, key))}")
        if not selections.get(key):
            raise ConfigError(
                f"the {path[-1]} plugin needs a {key} plugin, and the mission selects none"
            )
        plugins = tuple(make_one(key, chosen, path) for chosen in selections[key])
        made[key] = plugins if registry.is_plural(capability_of(key)) else plugins[0]
        return made[key]

    def make_one(key: str, chosen: Selection, path: tuple[str, ...]) -> Plugin:
        capability = capability_of(key)
        registry.require_extras(capability, chosen.name)
        plugin_class = registry.load(capability, chosen.name)
        services = {"machine": machine, "rng": seeded(seed, f"{key}/{chosen.name}", 0)}
        given = {
            name: services[name]
            if name in services
            else make(chosen_key(name, chosen.uses, selections) or name, (*path, key))
            for name in registry.dependencies_of(plugin_class)
        }
        try:
            plugin: Plugin = plugin_class(chosen.settings, **given)
        except Exception as error:
            error.add_note(f"while the {key} plugin '{chosen.name}' was made")
            raise
        order.append(plugin)
        return plugin

    for capability in registry.capabilities():
        for key, chosen in selections.items():
            if chosen and capability_of(key) == capability:
                make(key, ())
    return Assembly(machine, made, tuple(order))


def machine_of(selections: Selections, model: str) -> Machine:
    """Return the machine; it may tip, and its jaws do not dig, where the robot says so.

    Args:
        selections: All that a mission selects, its robot included.
        model: Name or folder of the machine.
    """
    machine = load_machine(model)
    chosen = [one.settings for one in selections.get("robot", ())]
    robots = [settings for settings in chosen if isinstance(settings, RobotSettings)]
    changed: dict[str, object] = {}
    if free := [one for one in robots if one.may_tip]:
        told: dict[str, bool | float] = {"is_free": True}
        if free[0].support_n_m is not None:
            told["support_n_m"] = free[0].support_n_m
        changed["stance"] = machine.stance.model_copy(update=told)
    slow = [one.legs_s for one in robots if one.legs_s]
    if slow and machine.driving is not None:
        changed["driving"] = machine.driving.model_copy(update={"legs_s": slow[0]})
    if any(one.ground == "rock" for one in robots):
        changed["gripper"] = machine.gripper.model_copy(update={"digs_m": 0.0})
    return machine.model_copy(update=changed) if changed else machine


def selected_plugins(plugins: Mapping[str, Any]) -> Iterator[tuple[str, str, Plugin]]:
    """Yield capability, name and plugin of all plugins of a mission.

    Of a plugin with a name, the capability is `capability.name`.
    """
    for key, plugin in each_plugin(plugins):
        yield key, registry.name_of(capability_of(key), type(plugin)), plugin


def each_plugin(plugins: Mapping[str, Any]) -> Iterator[tuple[str, Plugin]]:
    """Yield capability and plugin of all plugins of a mission."""
    for capability, several in plugins.items():
        for plugin in several if isinstance(several, tuple) else (several,):
            yield capability, plugin


def needed_for(selections: Selections, key: str) -> dict[str, tuple[Selection, ...]]:
    """Return the selections that a copy of one plugin needs, itself included, by key."""
    wanted, reached = [key], dict[str, tuple[Selection, ...]]()
    while wanted:
        one = wanted.pop()
        if one in reached:
            continue
        reached[one] = selections.get(one, ())
        for chosen in reached[one]:
            plugin = registry.load(capability_of(one), chosen.name)
            for name in registry.dependencies_of(plugin):
                if name in registry.capabilities():
                    wanted.append(chosen_key(name, chosen.uses, selections) or name)
    return reached


def seeded(seed: int, stream: str, number: int) -> np.random.Generator:
    """Return the random generator of a name and number: independent of others, reproducible."""
    return np.random.default_rng([seed, number, *stream.encode()])
