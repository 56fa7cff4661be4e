"""Leaves and conditions: the name of a behaviour, its settings, its wiring."""

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

from executive.config import Settings
from executive.errors import ConfigError, did_you_mean
from executive.interfaces.declaration import MachineSettings
from executive.leaf.action import Action, Leaf
from executive.leaf.action import Condition as ConditionLeaf
from executive.leaf.port import Port
from executive.tree.expressions.syntax import Truth
from executive.tree.instances import USE, read_uses
from executive.tree.key_source import Computed, KeySource, Ref, Source
from executive.tree.leaf_use import Combined, Condition, KeyHolds, LeafUse, Parameters
from executive.tree.problem import Mark
from executive.tree.reading import PlacedSettings, Reading, is_text, place_of
from executive.tree.region_reader import check_region_names
from executive.tree.setting_types import takes_text
from executive.tree.settings import check_settings
from executive.tree.value import Scalar, Table, TableEntry, Value, describe, plain, without

LEAF_KEYS = ("with", "in", "out", USE)
_NAME = re.compile(r"\w+")
_CONDITION_FORMS = (
    'a check\'s name, "{key}", an expression such as "{count} > 3", or a mapping with one of '
    "check, not, all, any"
)


class LeafReader:
    """Reads the values of `run`, `check`, `if`, `while` and `until`."""

    def __init__(self, reading: Reading) -> None:
        self._reading = reading

    def use(self, kind: str, table: Table, *, as_node: bool = True) -> LeafUse | None:
        """Read `run: Name` or `check: Name` with settings and ports, as a node or a condition."""
        value = table.entries[kind].value
        name = self._reading.text(value, f"'{kind}'")
        leaf = self._leaf(kind, name, value.mark, as_node) if name else None
        if leaf is None or name is None:
            return None
        given = table.get("with") or Table({}, value.mark)
        settings_table = self._reading.table(given, f"'with' of {name}")
        if settings_table is None:
            return None
        sources = self._computed(leaf.Settings, settings_table)
        literals = without(settings_table, tuple(sources))
        settings = check_settings(
            leaf.Settings, literals, name, self._reading.problems, computed=sources
        )
        check_region_names(leaf.Settings, settings_table, name, self._reading)
        if isinstance(settings, MachineSettings) and not sources:
            self._reading.placed.append(PlacedSettings(settings, settings_table))
        known = {port: source for port, source in sources.items() if source is not None}
        parameters = Parameters(plain(literals), known) if sources else None
        inputs = self._inputs(table.get("in"), leaf.inputs, name, value.mark)
        outputs = self._outputs(table.get("out"), leaf.outputs, name, value.mark)
        needed = tuple(need.capability for need in leaf.needs)
        use = table.get(USE)
        uses = {} if use is None else read_uses(self._reading, use, name, needed)
        return (
            LeafUse(name, leaf, settings, inputs, outputs, value.mark, parameters, uses)
            if settings is not None
            else None
        )

    def condition(self, value: Value, what: str) -> Condition | None:
        """Read a condition: a check's name, an expression, or a mapping with check, not, all or
        any.
        """
        if is_text(value):
            if not _NAME.fullmatch(str(value.value)):  # type: ignore[union-attr]
                source = self._reading.expression(value, what)
                return KeyHolds(source.key, source.mark) if isinstance(source, Ref) else source
            return self.use(
                "check", Table({"check": TableEntry(value.mark, value)}, value.mark), as_node=False
            )
        if isinstance(value, Scalar) and isinstance(value.value, bool):
            return Computed(Truth(value.value), place_of(value))
        if not isinstance(value, Table):
            self._reading.fail(value, f"{what} takes {_CONDITION_FORMS}; not {describe(value)}")
            return None
        return self._condition_table(value, what)

    def _condition_table(self, table: Table, what: str) -> Condition | None:
        found = [key for key in ("check", "not", "all", "any") if key in table.entries]
        if len(found) != 1:
            self._reading.known_keys(table, ("check", "not", "all", "any", *LEAF_KEYS), what)
            self._reading.fail(table, f"{what} takes {_CONDITION_FORMS}")
            return None
        how, value = found[0], table.entries[found[0]].value
        allowed = ("check", *LEAF_KEYS) if how == "check" else (how,)
        self._reading.known_keys(table, allowed, f"a condition with '{how}'")
        if how == "check":
            return self.use("check", table, as_node=False)
        if how == "not":
            part = self.condition(value, "'not'")
            return Combined("not", (part,)) if part else None
        listing = self._reading.listing(value, f"'{how}'")
        parts = [self.condition(item, f"'{how}'") for item in listing.items] if listing else []
        known = tuple(part for part in parts if part is not None)
        return (
            Combined("all" if how == "all" else "any", known)
            if known and len(known) == len(parts)
            else None
        )

    def _leaf(self, kind: str, name: str, mark: Mark, as_node: bool) -> type[Leaf[Any]] | None:
        try:
            leaf = self._reading.catalogue.behaviour(name)
        except ConfigError as error:
            self._reading.problems.error(mark, str(error))
            leaf_meant = self._meant(name)
            if leaf_meant is None:
                return None
            leaf = leaf_meant
        wanted, other = (Action, "check") if kind == "run" else (ConditionLeaf, "run")
        if issubclass(leaf, wanted):
            return leaf
        sort = (
            "a condition, which answers at once" if kind == "run" else "an action, which takes time"
        )
        cure = f": write '{other}: {name}'" if as_node else "; only a condition can be asked here"
        self._reading.problems.error(mark, f"{name} is {sort}{cure}")
        return None

    def _meant(self, name: str) -> type[Leaf[Any]] | None:
        """Return the leaf whose name was misspelt, so that what it writes is known all the same."""
        known = self._reading.catalogue.behaviour_names()
        near = get_close_matches(name, known, n=1, cutoff=0.8)
        try:
            return self._reading.catalogue.behaviour(near[0]) if near else None
        except ConfigError:  # it cannot be imported
            return None

    def _inputs(
        self, value: Value | None, ports: Mapping[str, Port], name: str, mark: Mark
    ) -> dict[str, Source]:
        inputs: dict[str, Source] = {port: Ref(port, mark, is_listed=False) for port in ports}
        table = self._reading.table(value, f"'in' of {name}") if value is not None else None
        for port, entry in table.entries.items() if table else ():
            if check_port(self._reading, "in", port, entry.key_mark, tuple(ports), name):
                source = self._input(entry.value, f"port '{port}'")
                inputs.update({port: source} if source else {})
        return inputs

    def _input(self, value: Value, what: str) -> Source | None:
        if is_text(value) and "{" in str(value.value):  # type: ignore[union-attr]
            return self._reading.expression(value, what)
        return self._reading.reference(value, what)

    def _outputs(
        self, value: Value | None, ports: Mapping[str, Port], name: str, mark: Mark
    ) -> dict[str, Ref]:
        defaults = {port: Ref(port, mark, is_listed=False) for port in ports}
        return {**defaults, **read_outputs(self._reading, value, tuple(ports), name)}

    def _computed(self, settings: type[Settings], table: Table) -> dict[str, KeySource | None]:
        """Read the settings that hold keys; None stands for one with a mistake."""
        sources: dict[str, KeySource | None] = {}
        for name, entry in table.entries.items():
            field = settings.model_fields.get(name)
            if field and is_text(entry.value) and "{" in str(entry.value.value):  # type: ignore[union-attr]
                sources[name] = self._setting(entry.value, f"'{name}'", takes_text(field))
        return sources

    def _setting(self, value: Value, what: str, is_text_wanted: bool) -> KeySource | None:
        if not is_text_wanted:
            return self._reading.expression(value, what)
        template = self._reading.template(value, what)
        if template is None or len(template.parts) > 1 or isinstance(template.parts[0], str):
            return template
        return self._reading.expression(value, what)


def read_outputs(
    reading: Reading, value: Value | None, ports: Sequence[str], owner: str
) -> dict[str, Ref]:
    """Read `out:`: the key of each port."""
    table = reading.table(value, f"'out' of {owner}") if value is not None else None
    wires: dict[str, Ref] = {}
    for port, entry in table.entries.items() if table else ():
        if check_port(reading, "out", port, entry.key_mark, ports, owner):
            ref = reading.reference(entry.value, f"port '{port}'")
            wires.update({port: ref} if ref else {})
    return wires


def check_port(
    reading: Reading, side: str, port: str, mark: Mark, ports: Sequence[str], owner: str
) -> bool:
    """Note a port that the owner does not have."""
    if port in ports:
        return True
    word = {"in": "input", "out": "output"}[side]
    reading.problems.error(mark, f"{owner} has no {word} '{port}'{did_you_mean(port, ports)}")
    return False
