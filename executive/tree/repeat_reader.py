"""Reads the nodes that repeat their body: loop, for_each, consume."""

from collections.abc import Callable

from executive.tree.key_source import Literally
from executive.tree.leaf_reader import LeafReader
from executive.tree.node_kinds import Consume, ForEach, Kind, Loop, Node
from executive.tree.reading import Reading
from executive.tree.value import Table, Value, describe


class RepeatReader:
    """Reads the nodes that repeat what stands under `do:`."""

    def __init__(self, reading: Reading, leaves: LeafReader, node: Callable[[Value], Node]) -> None:
        """Take the reader of conditions, and that of the nodes below."""
        self._reading, self._leaves, self._node = reading, leaves, node

    def loop(self, table: Table) -> Kind | None:
        """Read `loop`."""
        body = self._body(table, "loop")
        if describe(table.entries["loop"].value).strip("'") == "forever":
            return Loop(None, None, body) if body else None
        given = self._reading.table(table.entries["loop"].value, "'loop'")
        if given is None:
            return None
        self._reading.known_keys(given, ("until", "max"), "'loop'")
        if not given.entries:
            told = "'loop' needs 'until' or 'max'; 'loop: forever' has no end"
            self._reading.fail(given, told)
            return None
        until_value, max_value = given.get("until"), given.get("max")
        until = self._leaves.condition(until_value, "'until'") if until_value is not None else None
        rounds = self._reading.whole(max_value, "'max'") if max_value is not None else None
        return Loop(until, rounds, body) if body and (until or rounds) else None

    def for_each(self, table: Table) -> Kind | None:
        """Read `for_each`."""
        body = self._body(table, "for_each")
        given = self._item_and(table, "for_each", "in", 'a list or "{key}"')
        if given is None:
            return None
        item, value = given
        source = self._reading.source(value, "'in'")
        if isinstance(source, Literally) and not isinstance(source.value, list):
            told = f"'in' takes a list or \"{{key}}\", not {describe(value)}"
            self._reading.fail(value, told)
            return None
        return ForEach(item, source, body) if body and item and source else None

    def consume(self, table: Table) -> Kind | None:
        """Read `consume`."""
        body = self._body(table, "consume")
        given = self._item_and(table, "consume", "from", 'the "{key}" of a list')
        if given is None:
            return None
        item, value = given
        source = self._reading.reference(value, "'from'")
        return Consume(item, source, body) if body and item and source else None

    def _item_and(
        self, table: Table, kind: str, key: str, what: str
    ) -> tuple[str | None, Value] | None:
        """Return the name of the item, and the value under the key beside it."""
        given = self._reading.table(table.entries[kind].value, f"'{kind}'")
        if given is None:
            return None
        self._reading.known_keys(given, ("item", key), f"'{kind}'")
        item, value = given.get("item"), given.get(key)
        if item is None or value is None:
            self._reading.fail(given, f"'{kind}' needs 'item', a name, and '{key}', {what}")
            return None
        return self._reading.name(item, "'item'"), value

    def _body(self, table: Table, kind: str) -> Node | None:
        body = table.get("do")
        if body is None:
            mark = table.entries[kind].key_mark
            self._reading.problems.error(
                mark, f"'{kind}' needs 'do:' with the node that it repeats"
            )
            return None
        return self._node(body)
