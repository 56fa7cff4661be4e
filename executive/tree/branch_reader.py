"""Reads the nodes that choose: if/then/else, while/do/else, switch."""

from collections.abc import Callable

from executive.tree.expressions.syntax import Truth
from executive.tree.key_source import Computed
from executive.tree.kind_keys import ELSE_GOES_WITH, SKIP
from executive.tree.leaf_reader import LeafReader
from executive.tree.node_kinds import Branch, CheckKeys, Group, Kind, Modifiers, Node, Switch
from executive.tree.reading import Reading, is_text, place_of
from executive.tree.value import Table, Value, describe


class BranchReader:
    """Reads the nodes that choose one of their children."""

    def __init__(self, reading: Reading, leaves: LeafReader, node: Callable[[Value], Node]) -> None:
        """Take the reader of conditions, and that of the nodes below."""
        self._reading, self._leaves, self._node = reading, leaves, node

    def if_else(self, table: Table) -> Kind | None:
        """Read `if`, `then` and `else`."""
        then, asked = self._node(table.entries["then"].value), table.get("if")
        otherwise = self._otherwise(table)
        if asked is None:
            mark = table.entries["then"].key_mark
            self._reading.problems.error(mark, "'then' needs 'if:' with the condition")
            return None
        condition = self._leaves.condition(asked, "'if'")
        return Branch("if", condition, then, otherwise) if condition else None

    def group(self, table: Table) -> Kind | None:
        """Read `do`, and `while`, `do` and `else`."""
        body, otherwise = self._node(table.entries["do"].value), self._otherwise(table)
        if otherwise is None:
            return Group(body)
        asked = table.get("while")
        if asked is None:
            self._reading.problems.error(table.entries["else"].key_mark, ELSE_GOES_WITH)
            return None
        condition = self._leaves.condition(asked, "'while'")
        return Branch("while", condition, body, otherwise) if condition else None

    def switch(self, table: Table) -> Kind | None:
        """Read `switch`, `cases` and `else`."""
        source = self._reading.reference(table.entries["switch"].value, "'switch'")
        given = table.get("cases")
        otherwise = self._otherwise(table)
        if given is None:
            mark = table.entries["switch"].key_mark
            self._reading.problems.error(mark, "'switch' needs 'cases:' with a node for each value")
            return None
        listed = self._reading.table(given, "'cases'")
        if listed is None:
            return None
        if not listed.entries:
            self._reading.fail(listed, "'cases' needs at least one 'value: node'")
            return None
        cases = {name: self._node(entry.value) for name, entry in listed.entries.items()}
        return Switch(source, cases, otherwise) if source else None

    def _otherwise(self, table: Table) -> Node | None:
        value = table.get("else")
        if value is not None and is_text(value) and describe(value).strip("'") == SKIP:
            always, never = (Computed(Truth(one), place_of(value)) for one in (True, False))
            return Node(CheckKeys(always), Modifiers(if_=never), value.mark)
        return None if value is None else self._node(value)
