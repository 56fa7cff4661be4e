"""Installed plugins by capability and name; only what is selected is imported.

Every group is called `executive.<capability>.v1`. The group `executive.capability.v1` names the
interface of each capability, so that a package may bring a capability of its own.
"""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import Distribution, EntryPoint, entry_points
from typing import Any

from executive.config import Settings
from executive.errors import ConfigError, UnknownPluginError
from executive.extras import MissingExtraError, missing_packages, packages_of
from executive.interfaces.declaration import (
    Declared,
    PluginSettings,
    constructor_parameters,
    declared_by_class,
    declared_by_settings,
)
from executive.interfaces.plugin import Plugin

# The shipped ones, in the order in which data flows (docs/architecture.md).
CAPABILITIES = (
    "robot",
    "estimation",
    "odometry",
    "mapping",
    "segmentation",
    "surveying",
    "alignment",
    "registration",
    "objects",
    "motion",
    "driving",
    "grasping",
    "placing",
    "building",
    "monitoring",
    "viewing",
)
INTERFACES = "capability"  # the abstract class of each capability
EXERCISES = "exercise"  # checks of the conformance kit for the plugins of a capability
BEHAVIOURS = "behaviour"
ORACLES = "oracle"
JUDGES = "judge"  # of structures of stones, by the poses of the stones
NO_JUDGE = "none"
SMOOTHERS = "smoothing"  # of whole recordings: no mission selects one
CALIBRATORS = "calibration"  # of whole recordings, as smoothers
SETTINGS = "settings"  # the settings class of a plugin, apart from it
EXTRAS = "extra"  # the extra of its package that a plugin needs
WORKS = "work"  # kinds of bulk work that a campaign can spread
METRICS = "metric"  # what is measured on a run
VERBS = "verb"  # functions with typer's annotations: sub-commands of the command line


class BrokenPluginError(ConfigError):
    """A plugin is installed but cannot be imported or is no plugin."""


@dataclass(frozen=True, slots=True)
class Installed:
    """A plugin as its package announces it; nothing of it is imported yet.

    Attributes:
        capability: Its capability, or another group of entry points.
        name: Its name.
        target: `module:class`.
        distribution: The package that brings it.
        missing_extra: The extra of that package that it needs and that is not installed, or "".
    """

    capability: str
    name: str
    target: str
    distribution: str
    missing_extra: str


@cache
def _groups() -> Mapping[str, tuple[EntryPoint, ...]]:
    """Read what all installed packages announce: this opens a file of each of them."""
    found = entry_points()
    ours = (group for group in found.groups if group.startswith("executive."))
    return {group: tuple(found.select(group=group)) for group in ours}


@cache
def _entry_points(capability: str) -> Mapping[str, EntryPoint]:
    return {point.name: point for point in _groups().get(f"executive.{capability}.v1", ())}


def capabilities() -> tuple[str, ...]:
    """List the capabilities: the shipped ones in the order of the data, then others by name."""
    shipped = (*CAPABILITIES, SMOOTHERS)
    return (*CAPABILITIES, *sorted(set(_entry_points(INTERFACES)) - set(shipped)))


def interface(capability: str) -> type[Plugin]:
    """Import the abstract class that every plugin of a capability derives from.

    Raises:
        UnknownPluginError: If no installed package has a capability of that name.
        BrokenPluginError: If it cannot be imported, is no Plugin, or is the interface of another
            capability.
    """
    found = load(INTERFACES, capability)
    if not issubclass(found, Plugin):
        raise BrokenPluginError(
            f"capability '{capability}': {found.__qualname__} does not derive from Plugin"
        )
    if found.capability != capability:
        raise BrokenPluginError(
            f"capability '{capability}': {found.__qualname__}.capability is "
            f"'{found.capability}'; the entry point and the class must agree"
        )
    return found


def is_plural(capability: str) -> bool:
    """Return whether a mission may select several plugins of a capability, side by side."""
    return interface(capability).is_plural


def reread() -> None:
    """Forget what was found: packages that were installed since then are seen from now on."""
    for found in (_groups, _entry_points, _name, installed, packages_of):
        found.cache_clear()


@cache
def installed(capability: str) -> tuple[Installed, ...]:
    """List the plugins of a capability by name, without importing any."""
    return tuple(
        Installed(
            capability, name, _target(point), _distribution(point), _missing_extra(capability, name)
        )
        for name, point in sorted(_entry_points(capability).items())
    )


def names(capability: str) -> tuple[str, ...]:
    """List the names of a capability's plugins, without looking at the packages that bring them."""
    return tuple(sorted(_entry_points(capability)))


def require_extras(capability: str, name: str) -> None:
    """Refuse a plugin that needs an extra of its package which is not installed.

    The group `executive.extra.v1` says which extra a plugin needs: `"grasping.mine" = "learning"`.

    Raises:
        MissingExtraError: With the cure: the extra, or a plugin that does without.
    """
    extra = _missing_extra(capability, name)
    if not extra:
        return
    package = _distribution(_entry_points(EXTRAS)[f"{capability}.{name}"])
    others = [one.name for one in installed(capability) if not one.missing_extra]
    can_choose = capability in capabilities() and others
    cure = f"; or choose another: --set {capability}.plugin={others[0]}" if can_choose else ""
    missing = missing_packages(extra, package)
    raise MissingExtraError(f"{capability} plugin '{name}'", extra, missing, package, cure)


def _missing_extra(capability: str, name: str) -> str:
    """Return the extra that a plugin needs if it is not installed, else an empty text."""
    point = _entry_points(EXTRAS).get(f"{capability}.{name}")
    if point is None or not missing_packages(point.value, _distribution(point)):
        return ""
    return point.value


def _target(point: EntryPoint) -> str:
    return f"{point.module}:{point.attr}"


def _distribution(point: EntryPoint) -> str:
    return _name(point.dist) if point.dist else "?"


@cache
def _name(distribution: Distribution) -> str:
    return distribution.name  # each time it is asked for, the package's metadata are parsed


def load(capability: str, name: str) -> type[Any]:
    """Import one class: a plugin, a behaviour or an oracle.

    Raises:
        UnknownPluginError: If none of that name is installed; the message names the nearest.
        BrokenPluginError: If its import fails; the message holds the reason.
    """
    loaded = _loaded(capability, name)
    if not inspect.isclass(loaded):
        raise BrokenPluginError(f"{capability} plugin '{name}' ({loaded!r}) is no class")
    return loaded


def load_verb(name: str) -> Callable[..., None]:
    """Import the function of one sub-command.

    Raises:
        UnknownPluginError: If none of that name is installed; the message names the nearest.
        BrokenPluginError: If its import fails or it is no function; the message holds the reason.
    """
    loaded = _loaded(VERBS, name)
    if not inspect.isfunction(loaded):
        raise BrokenPluginError(f"{VERBS} '{name}' ({loaded!r}) is no function")
    return loaded


def _loaded(capability: str, name: str) -> Any:
    points = _entry_points(capability)
    if name not in points:
        raise UnknownPluginError(capability, name, points)
    try:
        return points[name].load()
    except (ImportError, AttributeError, SyntaxError, OSError) as error:
        if isinstance(error, ModuleNotFoundError):
            require_extras(capability, name)
        raise BrokenPluginError(
            f"{capability} plugin '{name}' ({_target(points[name])}) cannot be loaded: {error}"
        ) from error


def name_of(capability: str, plugin: type) -> str:
    """Return the name under which a plugin's class is installed, else the name of the class."""
    target = f"{plugin.__module__}:{plugin.__qualname__}"
    points = _entry_points(capability).items()
    return next((name for name, point in points if _target(point) == target), plugin.__name__)


def has_oracle(robot: type) -> bool:
    """Return whether something can judge what a robot's class has done, as a simulator can."""
    return name_of("robot", robot) in _entry_points(ORACLES)


def declared(capability: str, name: str) -> Declared:
    """Return what a plugin declares; it is imported if its settings are not announced apart.

    Raises:
        UnknownPluginError: If none of that name is installed; the message names the nearest.
        BrokenPluginError: If what has to be imported cannot be.
        MissingExtraError: If the extra that the plugin needs is not installed.
    """
    point = _entry_points(SETTINGS).get(f"{capability}.{name}")
    if name not in _entry_points(capability) or point is None:
        return declared_by_class(load(capability, name))
    require_extras(capability, name)
    settings = _loaded(SETTINGS, point.name)
    if not (inspect.isclass(settings) and issubclass(settings, PluginSettings)):
        raise BrokenPluginError(
            f"{capability} plugin '{name}': {_target(point)} is no class of PluginSettings"
        )
    return declared_by_settings(settings)


def settings_of(capability: str, name: str) -> type[Settings]:
    """Return the settings class of a plugin."""
    return declared(capability, name).settings


def dependencies_of(plugin: type[Plugin]) -> tuple[str, ...]:
    """Return the names of a plugin's constructor parameters after `settings`."""
    return constructor_parameters(plugin)
