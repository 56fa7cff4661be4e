"""Reads a mission's plugins: layers merged, names and settings checked, needs fulfilled."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from difflib import get_close_matches

from executive.errors import ConfigError
from executive.interfaces.declaration import Declared
from executive.registry import is_plural
from executive.tree.catalogue import REQUIRED, SERVICES, Catalogue
from executive.tree.instances import (
    SINGLE,
    USE,
    capability_of,
    chosen_key,
    instances_of,
    is_named,
    key_of,
    read_uses,
)
from executive.tree.leaf_use import LeafUse
from executive.tree.machine_check import Written
from executive.tree.problem import Mark
from executive.tree.reading import Reading
from executive.tree.selection import ON_ERROR, ON_ERROR_WORDS, Selection
from executive.tree.settings import check_settings
from executive.tree.value import Listing, Scalar, Table, TableEntry, Value, merged, without


def layered(base: Table, over: Table) -> Table:
    """Merge two `plugins:` tables: settings of the same plugin merge, another plugin replaces."""
    entries = dict(base.entries)
    for capability, entry in over.entries.items():
        known = entries.get(capability)
        new = normal(entry.value)
        value = _laid(normal(known.value), new) if known else new
        entries[capability] = TableEntry(entry.key_mark, value)
    return Table(entries, over.mark)


def normal(value: Value) -> Value:
    """Write the short forms out: `gicp` is `{plugin: gicp}`, also within a list."""
    if isinstance(value, Scalar):
        return Table({"plugin": TableEntry(value.mark, value)}, value.mark)
    if isinstance(value, Listing):
        return Listing(tuple(normal(item) for item in value.items), value.mark)
    return value


def _laid(base: Value, new: Value) -> Value:
    if not isinstance(base, Table) or not isinstance(new, Table):
        return new
    if is_named(base) and "plugin" not in new.entries:
        return _instances_laid(base, new)
    if is_named(new):
        return new
    chosen = new.get("plugin")
    same = chosen is None or _name(base) == _name(new)
    return merged(base, new) if same else new


def _instances_laid(base: Table, new: Table) -> Table:
    """Lay plugins with names over those of a lower layer, name by name."""
    entries = dict(base.entries)
    for name, entry in new.entries.items():
        known = entries.get(name)
        value = _laid(known.value, entry.value) if known else entry.value
        entries[name] = TableEntry(entry.key_mark, value)
    return Table(entries, new.mark)


def _is_empty(value: Value) -> bool:
    """Whether a layer takes back what a lower one selects: `monitoring: []`."""
    return isinstance(value, Listing) and not value.items


def _name(table: Table) -> object:
    value = table.get("plugin")
    return value.value if isinstance(value, Scalar) else None


def plugin_of(capability: str, table: Table, reading: Reading) -> tuple[str, Declared] | None:
    """Return a table's plugin and what it declares, or None after a mistake was reported."""
    chosen = table.get("plugin")
    if chosen is None:
        known = ", ".join(reading.catalogue.plugin_names(capability))
        reading.fail(table, f"{capability} needs 'plugin: name'; there is: {known or 'none'}")
        return None
    name = reading.text(chosen, "'plugin'")
    if name is None:
        return None
    try:
        return name, reading.catalogue.declared(capability, name)
    except ConfigError as error:
        reading.fail(chosen, str(error))
        return None


class PluginReader:
    """Reads `plugins:`."""

    def __init__(self, reading: Reading) -> None:
        self._reading = reading
        self._marks: dict[str, Mark] = {}
        self._used: set[str] = set()  # capabilities that a leaf calls
        self.written: list[Written] = []  # what was selected, and where
        self._uses: dict[str, Value] = {}  # what `use:` says, by key

    def read(self, table: Table) -> dict[str, tuple[Selection, ...]]:
        """Return the selections by capability, in the order in which data flows."""
        capabilities = self._reading.catalogue.capabilities()
        self._reading.known_keys(table, capabilities, "'plugins'")
        for key in table.entries.keys() - set(capabilities):  # reported, and not as missing too
            for meant in get_close_matches(key, capabilities, n=1):
                self._marks[meant] = table.entries[key].key_mark
        found: dict[str, tuple[Selection, ...]] = {}
        for capability in capabilities:
            entry = table.entries.get(capability)
            if entry is not None and not _is_empty(entry.value):
                self._marks[capability] = entry.key_mark
                value = normal(entry.value)
                if is_named(value) and isinstance(value, Table):
                    found |= self._named(capability, value)
                else:
                    found[capability] = self._several(capability, value)
        return self._with_uses(found)

    def _named(self, capability: str, table: Table) -> dict[str, tuple[Selection, ...]]:
        """Return the selections of plugins with names, by `capability.name`."""
        if capability in SINGLE:
            told = (
                f"{capability} takes one plugin, without a name: the mission itself uses it"
                if not is_plural(capability)
                else f"{capability} takes a list of plugins, without names: all of them are used"
            )
            self._reading.fail(table, told)
            return {}
        found: dict[str, tuple[Selection, ...]] = {}
        for name, entry in table.entries.items():
            if self._reading.checked_name(name, entry.key_mark, "the name of a plugin"):
                one = self._one(capability, entry.value, key_of(capability, name))
                found[key_of(capability, name)] = (one,) if one else ()
        return found

    def _with_uses(
        self, found: dict[str, tuple[Selection, ...]]
    ) -> dict[str, tuple[Selection, ...]]:
        """Return the selections with what they choose among plugins with names."""
        reading = replace(self._reading, instances=instances_of(found))
        chosen = dict(found)
        for key, use in self._uses.items():
            for one in found.get(key, ()):
                declared = self._reading.catalogue.declared(capability_of(key), one.name)
                uses = read_uses(reading, use, f"the plugin '{one.name}'", declared.dependencies)
                chosen[key] = (replace(one, uses=uses),)
        return chosen

    def _several(self, capability: str, value: Value) -> tuple[Selection, ...]:
        if not isinstance(value, Listing):
            one = self._one(capability, value, capability)
            return (one,) if one else ()
        if not is_plural(capability):
            plural = filter(is_plural, self._reading.catalogue.capabilities())
            self._reading.fail(
                value,
                f"{capability} takes one plugin, not a list; only {', '.join(plural)} may have "
                "several",
            )
            return ()
        chosen = [self._one(capability, item) for item in value.items]
        names = [one.name for one in chosen if one]
        if len(set(names)) < len(names):
            self._reading.fail(value, f"a {capability} plugin is listed twice")
        return tuple(one for one in chosen if one)

    def _one(self, capability: str, value: Value, key: str = "") -> Selection | None:
        """Read one plugin; without a key it is one of a list, which chooses nothing by name."""
        table = self._reading.table(value, f"the {key or capability} plugin")
        chosen = plugin_of(capability, table, self._reading) if table else None
        if table is None or chosen is None:
            return None
        name, plugin = chosen
        can_fail = self._can_fail(capability, table)
        use = table.get(USE) if key else None
        if use is not None:
            self._uses[key] = use
        own = without(table, ["plugin", ON_ERROR, *([USE] if key else [])])
        settings = check_settings(plugin.settings, own, name, self._reading.problems)
        if settings is None:
            return None
        selection = Selection(name, settings, can_fail)
        self.written.append(Written(capability, selection, table))
        return selection

    def _can_fail(self, capability: str, table: Table) -> bool:
        """Return whether the mission goes on when the plugin raises an error."""
        value = table.get(ON_ERROR)
        if value is None:
            return capability == "viewing"  # the machine is not stopped for a picture
        word = self._reading.text(value, f"'{ON_ERROR}'")
        if word is not None and word not in ON_ERROR_WORDS:
            self._reading.fail(value, f"'{ON_ERROR}' is {' or '.join(ON_ERROR_WORDS)}, not {word}")
        elif word == "fail" and capability in REQUIRED:
            self._reading.fail(value, f"no mission can do without its {capability} plugin")
        return word == "fail"

    # --- what is needed

    def check_needs(
        self, chosen: Mapping[str, tuple[Selection, ...]], table: Table, uses: Iterable[LeafUse]
    ) -> None:
        """Note what the loop, a leaf or a plugin needs and the mission does not select."""
        if not table.entries:
            self._reading.problems.error(
                table.mark, "'plugins' is missing: a mission chooses at least a robot"
            )
            return
        for capability in REQUIRED:
            if capability not in self._marks:
                self._missing(table.mark, "a mission", capability)
        uses = tuple(uses)
        self._used = {interface.capability for use in uses for interface in use.leaf.needs}
        for use in uses:
            for interface in use.leaf.needs:
                if interface.capability not in self._marks:
                    self._missing(use.mark, use.name, interface.capability)
        for key, selections in chosen.items():
            for one in selections:
                self._check_dependencies(capability_of(key), one, chosen)

    def _check_dependencies(
        self, capability: str, one: Selection, chosen: Mapping[str, tuple[Selection, ...]]
    ) -> None:
        mark = self._marks[capability]
        declared = self._reading.catalogue.declared(capability, one.name)
        for need in declared.needs if capability in self._used else ():  # else it is never asked
            self._check_facility(mark, f"the {capability} plugin '{one.name}'", need, one, chosen)
        for name in declared.dependencies:
            names = instances_of(chosen).get(name, ())
            if names and chosen_key(name, one.uses, chosen) is None:
                told = (
                    f"the {capability} plugin '{one.name}' is given a {name} plugin, and the "
                    f"mission has several: {', '.join(names)}; choose one with "
                    f"'use: {names[0]}' beside 'plugin: {one.name}'"
                )
                self._reading.problems.error(mark, told)
            if name in SERVICES or name in self._marks:
                continue
            if name in self._reading.catalogue.capabilities():
                self._missing(mark, f"the {capability} plugin '{one.name}'", name)
            else:
                told = (
                    f"the {capability} plugin '{one.name}' asks for '{name}', no capability "
                    "and no service"
                )
                self._reading.problems.error(mark, told)

    def _check_facility(
        self,
        mark: Mark,
        who: str,
        need: str,
        one: Selection,
        chosen: Mapping[str, tuple[Selection, ...]],
    ) -> None:
        """Note a need such as `robot.scene` that the selected plugin does not fulfil."""
        capability, _, facility = need.partition(".")
        key = chosen_key(capability, one.uses, chosen) if facility else None
        giver = chosen[key][0].name if key and chosen.get(key) else ""
        catalogue = self._reading.catalogue
        if not giver or facility in catalogue.declared(capability, giver).gives:
            return
        able = [
            name
            for name in catalogue.plugin_names(capability)
            if _gives(catalogue, capability, name, facility)
        ]
        cure = f"; choose {capability}: {' or '.join(able)}, or another plugin" if able else ""
        told = f"{who} needs a {capability} with '{facility}', and '{giver}' has none{cure}"
        self._reading.problems.error(mark, told)

    def _missing(self, mark: Mark, who: str, capability: str) -> None:
        names = self._reading.catalogue.plugin_names(capability)
        cure = (
            f"; add '{capability}: {names[0]}' to 'plugins'" if names else ", and none is installed"
        )
        article = "an" if capability[0] in "aeiou" else "a"
        self._reading.problems.error(
            mark, f"{who} needs {article} {capability} plugin, and none is selected{cure}"
        )


def _gives(catalogue: Catalogue, capability: str, name: str, facility: str) -> bool:
    try:
        return facility in catalogue.declared(capability, name).gives
    except ConfigError:  # one that cannot be imported gives nothing
        return False
