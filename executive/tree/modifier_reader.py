"""Reads the modifiers of a node: if, once, while, timeout, retry, on_failure, optional, on_halt."""

import re
from collections.abc import Callable

from executive.tree.key_source import Template
from executive.tree.kind_keys import MODIFIERS
from executive.tree.leaf_reader import LeafReader
from executive.tree.node_kinds import Attempts, Branch, Kind, Modifiers, Node
from executive.tree.reading import Reading, is_text
from executive.tree.traversal import is_instant
from executive.tree.value import Table, Value

_KEYS = frozenset(MODIFIERS)
_NONE = Modifiers()
_NAME = re.compile(r"[^/@\n\t]{1,60}")


class ModifierReader:
    """Reads what stands beside a node's kind."""

    def __init__(self, reading: Reading, leaves: LeafReader, node: Callable[[Value], Node]) -> None:
        """Take the reader of conditions, and that of the nodes below."""
        self._reading, self._leaves, self._node = reading, leaves, node

    def modifiers(self, table: Table, kind: Kind | None) -> Modifiers:
        """Read the modifiers; `kind` is what the node is, None if it was refused."""
        if _KEYS.isdisjoint(table.entries):
            return _NONE
        own = kind.kind if isinstance(kind, Branch) else ""  # a condition of the kind itself
        reading = self._reading

        def get(key: str) -> Value | None:
            return None if key == own else table.get(key)

        if_, while_, timeout, retry = get("if"), get("while"), get("timeout"), get("retry")
        recovery, optional, name = get("on_failure"), get("optional"), get("name")
        once, on_halt = get("once"), get("on_halt")
        modifiers = Modifiers(
            if_=None if if_ is None else self._leaves.condition(if_, "'if'"),
            once=bool(once is not None and reading.truth(once, "'once'")),
            while_=None if while_ is None else self._leaves.condition(while_, "'while'"),
            timeout_s=None if timeout is None else reading.seconds(timeout, "'timeout'"),
            retry=None if retry is None else self._attempts(retry),
            on_failure=None if recovery is None else self._node(recovery),
            optional=bool(optional is not None and reading.truth(optional, "'optional'")),
            on_halt=None if on_halt is None else self._on_halt(on_halt),
            name="" if name is None else self._name(name),
            title=None if name is None else self._title(name),
        )
        self._refuse_dead(table, modifiers)
        return modifiers

    def _on_halt(self, value: Value) -> Node:
        node = self._node(value)
        if not is_instant(node):
            told = (
                f"{node.label} takes time, and 'on_halt' is ticked once, when its node is "
                "cancelled; it takes 'set', 'check' and what is made of them"
            )
            self._reading.problems.error(node.mark, told)
        return node

    def _attempts(self, value: Value) -> Attempts | None:
        if not isinstance(value, Table):
            count = self._reading.whole(value, "'retry'")
            return Attempts(count) if count else None
        self._reading.known_keys(value, ("attempts", "pause"), "'retry'")
        count_value, pause = value.get("attempts"), value.get("pause")
        if count_value is None:
            self._reading.fail(value, "'retry' needs 'attempts'")
            return None
        count = self._reading.whole(count_value, "'attempts'")
        pause_s = 0.0 if pause is None else self._reading.seconds(pause, "'pause'", allow_zero=True)
        return Attempts(count, pause_s) if count and pause_s is not None else None

    def _name(self, value: Value) -> str:
        name = self._reading.text(value, "'name'")
        if name is not None and not _NAME.fullmatch(name):
            self._reading.fail(
                value, "'name' is at most 60 characters on one line, without / and @"
            )
        return name or ""

    def _title(self, value: Value) -> Template | None:
        has_keys = is_text(value) and "{" in str(value.value)  # type: ignore[union-attr]
        return self._reading.template(value, "'name'") if has_keys else None

    def _refuse_dead(self, table: Table, modifiers: Modifiers) -> None:
        dead = [key for key in ("retry", "on_failure") if key in table.entries]
        if modifiers.optional and dead:
            self._reading.problems.error(
                table.entries["optional"].key_mark,
                f"'optional' is applied inside {' and '.join(map(repr, dead))}, which "
                "would then never see a failure: "
                "give it to a node around this one (optional: true, do: …)",
            )
