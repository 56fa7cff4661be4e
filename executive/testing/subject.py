"""The plugin under test: which one, with which settings, and what it is given."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field

import numpy as np

from executive import registry
from executive.config import Settings
from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from executive.interfaces.robot import Robot, RobotSettings
from executive.machine.machine import Machine, load_machine
from executive.testing.paced import pace
from executive.testing.stand_ins import STAND_INS
from executive.tree.choices import Choices
from executive.tree.selection import Selection


@dataclass(frozen=True, slots=True)
class Subject:
    """An installed plugin by name; picklable, so that another process makes the same one.

    Attributes:
        capability: Its capability, such as `segmentation`.
        name: Its name, as `executive plugins list` shows it.
        settings: Its checked settings.
        model: The machine that it is made for.
        companions: The plugin to give for each capability that it needs; where none is chosen, a
            stand-in, or else the first installed one.
        seed: All chance of its constructor follows from it.
    """

    capability: str
    name: str
    settings: Settings
    model: str = "m545"
    companions: Mapping[str, Selection] = field(default_factory=dict)
    seed: int = 1

    @property
    def plugin_class(self) -> type[Plugin]:
        """The class behind the name; imports it."""
        loaded: type[Plugin] = registry.load(self.capability, self.name)
        return loaded

    @property
    def machine(self) -> Machine:
        """The machine: a robot's own, where its settings name one."""
        own = self.settings.model if isinstance(self.settings, RobotSettings) else None
        return load_machine(own or self.model)

    def make(self, stack: ExitStack) -> Plugin:
        """Return a new plugin, not started; what it needs is started, and closed by the stack."""
        return self._made(self.plugin_class, self.settings, (), stack)

    @contextmanager
    def started(self) -> Iterator[Plugin]:
        """Give a new plugin, started; it is closed at the end, also after an error."""
        with ExitStack() as stack:
            plugin = self.make(stack)
            stack.callback(plugin.close)
            plugin.start()
            if isinstance(plugin, Robot) and plugin.has_own_clock:
                pace(plugin)
            yield plugin

    def _made(
        self, plugin: type[Plugin], settings: Settings, path: tuple[str, ...], stack: ExitStack
    ) -> Plugin:
        names = registry.dependencies_of(plugin)
        given = {name: self._given(name, path, stack) for name in names}
        made: Plugin = plugin(settings, **given)  # type: ignore[call-arg]
        return made

    def _given(self, name: str, path: tuple[str, ...], stack: ExitStack) -> object:
        if name == "machine":
            return self.machine
        if name == "rng":
            return np.random.default_rng(self.seed)
        if name in path:
            raise ConfigError(f"plugins need each other in a circle: {' → '.join((*path, name))}")
        chosen = self.companions.get(name)
        if chosen is None and name in STAND_INS:
            return STAND_INS[name]()
        if chosen is None and not registry.installed(name):
            raise ConfigError(
                f"the {self.capability} plugin '{self.name}' asks for '{name}', which is neither "
                "machine, rng nor a capability with an installed plugin"
            )
        if chosen is None:
            first = registry.installed(name)[0].name
            chosen = Selection(first, registry.load(name, first).Settings())
        plugin = registry.load(name, chosen.name)
        companion = self._made(plugin, chosen.settings, (*path, name), stack)
        stack.callback(companion.close)
        companion.start()
        return companion


def subject_of(
    capability: str, name: str, options: Sequence[str] = (), model: str = "m545"
) -> Subject:
    """Return an installed plugin with the settings and companions that options choose.

    Args:
        capability: Its capability.
        name: Its name.
        options: `capability.field=value` or `capability.plugin=name`, as `--set` takes them.
        model: The machine that it is made for.

    Raises:
        ConfigError: If there is no such plugin, or an option is wrong or missing.
    """
    source = f"executive plugins test {capability} {name}"
    choices = Choices((capability,), options, {capability: name}, source)
    chosen = {option.partition(".")[0] for option in options} - {capability}
    companions = {other: choices.selection(other) for other in sorted(chosen)}
    return Subject(
        capability, name, choices.selection(capability, name).settings, model, companions
    )
