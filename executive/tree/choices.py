"""The plugins of a command that runs no mission: the shipped defaults, and `--set` over them."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from executive.config import Settings
from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from executive.tree.catalogue import Catalogue, InstalledCatalogue
from executive.tree.document import read_file
from executive.tree.override import apply_override
from executive.tree.plugin_reader import layered, normal, plugin_of
from executive.tree.problem import Mark, Problems, one_line
from executive.tree.reading import Reading
from executive.tree.selection import ON_ERROR, Selection
from executive.tree.settings import check_settings
from executive.tree.sources import shipped_folder
from executive.tree.value import Listing, Scalar, Table, TableEntry, Value, merged, without

BASE = "base.yaml"  # the default plugin of each capability, for missions and commands alike

# Settings that a command knows itself, for a settings class; `--set` goes over them.
Known = Callable[[type[Settings]], Mapping[str, Any]]


class Choices:
    """Which plugins a command uses, and with which settings."""

    def __init__(
        self,
        uses: Sequence[str],
        options: Sequence[str] = (),
        defaults: Mapping[str, Any] | None = None,
        source: str = "command line",
        catalogue: Catalogue | None = None,
    ) -> None:
        """Lay the command's own defaults and then the options over the shipped defaults.

        Args:
            uses: The capabilities that the command calls; what their plugins need is added.
            options: `capability.field=value` or `capability.plugin=name`, as of `--set`.
            defaults: Where the command differs from the shipped defaults: a plugin's name, or a
                list of names, for a capability.
            source: Where those are from, for messages.
            catalogue: What can be chosen; all that is installed by default.

        Raises:
            MissionFileError: If an option is wrong, names a plugin that is not installed, or sets
                something that the command does not use.
        """
        self._reading = Reading(catalogue or InstalledCatalogue(), Problems())
        self._mark = Mark(source)
        base = _shipped(self._reading)
        self._plugins = layered(base, _table(defaults or {}, self._mark))
        for option in options:
            _, self._plugins = apply_override(
                option, Table({}, self._mark), self._plugins, self._reading
            )
        self._used = self._reached(uses)
        self._refuse_unused(options)
        self._reading.problems.raise_errors()

    @property
    def model(self) -> str:
        """Return the machine that the shipped missions are for."""
        robot = self._plugins.get("robot")
        model = robot.get("model") if isinstance(robot, Table) else None
        return str(model.value) if isinstance(model, Scalar) else ""

    def names(self, capability: str) -> tuple[str, ...]:
        """Return the names of the plugins that are chosen for a capability; none if it is off."""
        chosen = (table.get("plugin") for table in self._tables(capability))
        return tuple(str(one.value) for one in chosen if isinstance(one, Scalar))

    def name(self, capability: str) -> str:
        """Return the name of the one plugin that is chosen for a capability.

        Raises:
            ConfigError: If none is chosen, or several are.
        """
        names = self.names(capability)
        if len(names) != 1:
            raise ConfigError(
                f"one {capability} plugin is needed, and {len(names) or 'none'} "
                f"{'are' if names else 'is'} chosen; --set {capability}.plugin=NAME chooses one"
            )
        return names[0]

    def plugin(self, capability: str, name: str) -> type[Plugin]:
        """Return the class of a plugin.

        Raises:
            ConfigError: If none of that name is installed, or it cannot be imported.
        """
        return self._reading.catalogue.plugin(capability, name)

    def selection(
        self, capability: str, name: str | None = None, known: Known | None = None
    ) -> Selection:
        """Return a plugin with its checked settings.

        Args:
            capability: Its capability.
            name: Its name; the chosen one by default.
            known: Settings that the command knows itself; what was set goes over them.

        Raises:
            MissionFileError: If a setting is wrong.
            ConfigError: If none of that name is installed.
        """
        name = name or self.name(capability)
        settings_class = self._reading.catalogue.declared(capability, name).settings
        own = _table({} if known is None else known(settings_class), self._mark)
        laid = merged(own, without(self._table_of(capability, name), ["plugin", ON_ERROR]))
        table = self._reading.table(laid, f"the settings of {name}")
        problems = self._reading.problems
        settings = check_settings(settings_class, table, name, problems) if table else None
        problems.raise_errors()
        if settings is None:
            raise ConfigError(f"the settings of {capability} plugin '{name}' cannot be read")
        return Selection(name, settings)

    def selections(
        self, known: Mapping[str, Known] | None = None
    ) -> dict[str, tuple[Selection, ...]]:
        """Return all plugins that the command uses, by capability, with what they need.

        Raises:
            MissionFileError: If a setting is wrong.
        """
        return {
            capability: tuple(
                self.selection(capability, name, (known or {}).get(capability))
                for name in self.names(capability)
            )
            for capability in self._used
        }

    def _tables(self, capability: str) -> list[Table]:
        value = self._plugins.get(capability)
        known = Listing((), self._mark) if value is None else normal(value)
        items = known.items if isinstance(known, Listing) else (known,)
        return [item for item in items if isinstance(item, Table)]

    def _table_of(self, capability: str, name: str) -> Table:
        chosen = dict(zip(self.names(capability), self._tables(capability), strict=False))
        return chosen.get(name, Table({}, self._mark))

    def _reached(self, uses: Sequence[str]) -> tuple[str, ...]:
        """Return the capabilities that are used, and those that their plugins need, in order."""
        wanted, found = list(uses), list[str]()
        while wanted:
            capability = wanted.pop(0)
            if capability in found:
                continue
            found.append(capability)
            for table in self._tables(capability):
                chosen = plugin_of(capability, table, self._reading)
                needed = chosen[1].dependencies if chosen else ()
                wanted.extend(n for n in needed if n in self._reading.catalogue.capabilities())
        return tuple(c for c in self._reading.catalogue.capabilities() if c in found)

    def _refuse_unused(self, options: Sequence[str]) -> None:
        for option in options:
            capability = option.partition("=")[0].strip().split(".")[0]
            known = ("loop", *self._reading.catalogue.capabilities())
            if capability in known and capability not in self._used:
                self._reading.problems.error(
                    Mark(one_line(f"--set {option}")),
                    f"this command does not use '{capability}'; it uses {', '.join(self._used)}",
                )


def _shipped(reading: Reading) -> Table:
    document = read_file(shipped_folder() / BASE, BASE, reading.problems)
    plugins = document.get("plugins") if isinstance(document, Table) else None
    return plugins if isinstance(plugins, Table) else Table({}, Mark(BASE))


def _table(values: Mapping[str, Any], mark: Mark) -> Table:
    return Table(
        {key: TableEntry(mark, _value(value, mark)) for key, value in values.items()}, mark
    )


def _value(value: Any, mark: Mark) -> Value:
    if isinstance(value, Mapping):
        return _table(value, mark)
    if isinstance(value, list | tuple):
        return Listing(tuple(_value(item, mark) for item in value), mark)
    return Scalar(value, mark)
