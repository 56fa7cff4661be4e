"""Construction of plugins for a recorded log."""

from typing import Any

import numpy as np

from executive import registry
from executive.config import Settings
from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from executive.machine.rig import Rig


def made(plugin: type[Plugin], settings: Settings, rig: Rig) -> Any:
    """Return the plugin, constructed with what a log provides: the rig and a random generator.

    Raises:
        ConfigError: If the plugin needs anything else.
    """
    services = {"machine": rig, "rng": np.random.default_rng(1)}
    needed = registry.dependencies_of(plugin)
    missing = [name for name in needed if name not in services]
    if missing:
        raise ConfigError(
            f"{plugin.__name__} needs {', '.join(missing)}, which a log does not provide; "
            "choose a plugin that needs only 'machine' and 'rng'"
        )
    return plugin(settings, **{name: services[name] for name in needed})  # type: ignore[call-arg]
