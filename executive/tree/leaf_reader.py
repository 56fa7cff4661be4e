"""Leaves and conditions: the name of a behaviour, its settings, its wiring."""

from collections.abc import Mapping, Sequence
from typing import Any

from executive.errors import ConfigError, did_you_mean
from executive.leaf.action import Action, Leaf
from executive.leaf.action import Condition as ConditionLeaf
from executive.leaf.port import Port
from executive.tree.language import Combined, Condition, KeyHolds, LeafUse, Ref
from executive.tree.problem import Mark
from executive.tree.reading import Reading, is_text
from executive.tree.settings import check_settings
from executive.tree.value import Table, TableEntry, Value, describe

LEAF_KEYS = ("with", "in", "out")
_CONDITION_FORMS = 'a check\'s name, "{key}", or a mapping with one of check, not, all, any'


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
        settings = (
            check_settings(leaf.Settings, settings_table, name, self._reading.problems)
            if settings_table
            else None
        )
        inputs = self._wiring("in", table.get("in"), leaf.inputs, name, value.mark)
        outputs = self._wiring("out", table.get("out"), leaf.outputs, name, value.mark)
        return (
            LeafUse(name, leaf, settings, inputs, outputs, value.mark)
            if settings is not None
            else None
        )

    def condition(self, value: Value, what: str) -> Condition | None:
        """Read a condition: `"{key}"`, a check's name, or a mapping with check, not, all or any."""
        if is_text(value):
            text = value.value  # type: ignore[union-attr]
            if "{" in text:  # type: ignore[operator]
                ref = self._reading.reference(value, what)
                return KeyHolds(ref.key, ref.mark) if ref else None
            return self.use(
                "check", Table({"check": TableEntry(value.mark, value)}, value.mark), as_node=False
            )
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
            return None
        wanted, other = (Action, "check") if kind == "run" else (ConditionLeaf, "run")
        if issubclass(leaf, wanted):
            return leaf
        sort = (
            "a condition, which answers at once" if kind == "run" else "an action, which takes time"
        )
        cure = f": write '{other}: {name}'" if as_node else "; only a condition can be asked here"
        self._reading.problems.error(mark, f"{name} is {sort}{cure}")
        return None

    def _wiring(
        self, side: str, value: Value | None, ports: Mapping[str, Port], name: str, mark: Mark
    ) -> dict[str, Ref]:
        wires = read_wires(self._reading, side, value, tuple(ports), name)
        defaults = {port: Ref(port, mark, is_listed=False) for port in ports}
        return {**defaults, **{port: wire for port, wire in wires.items() if isinstance(wire, Ref)}}


def read_wires(
    reading: Reading, side: str, value: Value | None, ports: Sequence[str], owner: str
) -> dict[str, Ref]:
    """Read `in:` or `out:`: references by port."""
    table = reading.table(value, f"'{side}' of {owner}") if value is not None else None
    wires: dict[str, Ref] = {}
    for port, entry in table.entries.items() if table else ():
        if check_port(reading, side, port, entry.key_mark, ports, owner):
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
