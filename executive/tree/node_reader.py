"""Nodes: a mapping with one kind key and modifiers becomes a checked description."""

from collections.abc import Callable, Mapping, Sequence

from executive.errors import did_you_mean
from executive.tree.ask_reader import read_ask
from executive.tree.branch_reader import BranchReader
from executive.tree.call_reader import CallReader, Ports
from executive.tree.key_source import Computed, Source
from executive.tree.kind_keys import ELSE_GOES_WITH, KINDS, MODIFIERS, REPEATING
from executive.tree.leaf_reader import LEAF_KEYS, LeafReader
from executive.tree.leaf_use import KeyHolds
from executive.tree.modifier_reader import ModifierReader
from executive.tree.node_kinds import (
    UNREADABLE,
    CheckKeys,
    CheckLeaf,
    Composite,
    Kind,
    Modifiers,
    Node,
    Parallel,
    RunLeaf,
    Set,
    Turned,
    Wait,
)
from executive.tree.reading import Reading, is_text
from executive.tree.repeat_reader import RepeatReader
from executive.tree.value import Scalar, Table, Value, describe, without

_ALLOWED = {kind: frozenset((kind, *keys, *MODIFIERS)) for kind, keys in KINDS.items()}


class NodeReader:
    """Reads nodes; `headers` are the ports of every tree that can be called, by name."""

    def __init__(self, reading: Reading, headers: Mapping[str, tuple[Ports, Ports]]) -> None:
        self._reading = reading
        self._headers = headers
        self._leaves = LeafReader(reading)
        below = (reading, self._leaves, self.node)
        self._modifiers = ModifierReader(*below)
        branch, repeat = BranchReader(*below), RepeatReader(*below)
        call = CallReader(reading, headers)
        self._kinds: Mapping[str, Callable[[Table], Kind | None]] = {
            **{
                kind: self._composite(kind)
                for kind in KINDS
                if kind.endswith(("sequence", "fallback"))
            },
            "parallel": self._parallel,
            "not": self._turned("not"),
            "force_failure": self._turned("force_failure"),
            "then": branch.if_else,
            "switch": branch.switch,
            "loop": repeat.loop,
            "for_each": repeat.for_each,
            "consume": repeat.consume,
            "run": self._run,
            "check": self._check,
            "wait": self._wait,
            "set": self._set,
            "ask": self._ask,
            "call": call.call,
            "do": branch.group,
        }

    def node(self, value: Value) -> Node:
        """Read a node; one with mistakes is reported, and becomes an unreadable node."""
        return self._node(value) or Node(Composite(UNREADABLE, ()), Modifiers(), value.mark)

    def _node(self, value: Value) -> Node | None:
        table = self._node_table(value)
        kind = self._kind_of(table) if table else None
        if table is None or kind is None:
            return None
        if not table.entries.keys() <= _ALLOWED[kind]:
            self._refuse_keys(table, kind)
        what = self._kinds[kind](table)
        modifiers = self._modifiers.modifiers(table, what)
        return Node(what, modifiers, table.entries[kind].key_mark) if what is not None else None

    def _refuse_keys(self, table: Table, kind: str) -> None:
        if "else" in table.entries and "else" not in _ALLOWED[kind]:
            self._reading.problems.error(table.entries["else"].key_mark, ELSE_GOES_WITH)
        shown = _shown_kind(kind, table)
        article = "an" if shown[0] in "aeiou" else "a"
        what = f"{article} '{shown}' node"
        if "with" in table.entries and "with" not in _ALLOWED[kind]:
            told = f"'with' gives settings to a leaf, 'run' or 'check'; {what} has none"
            self._reading.problems.error(table.entries["with"].key_mark, told)
        beside = without(table, ["else", "with", kind])
        self._reading.known_keys(beside, _ALLOWED[kind] - {kind}, what)

    def _node_table(self, value: Value) -> Table | None:
        if isinstance(value, Table):
            return value
        name = describe(value).strip("'")
        cure = (
            f"; did you mean 'run: {name}'?"
            if name in self._reading.catalogue.behaviour_names()
            else ""
        )
        self._reading.fail(
            value, f"a node is a mapping such as 'run: Name', not {describe(value)}{cure}"
        )
        return None

    def _kind_of(self, table: Table) -> str | None:
        found = [key for key in table.entries if key in KINDS]
        if len(found) == 1:
            return found[0]
        found.sort(key=tuple(KINDS).index)
        if len(found) == 2 and found[0] in REPEATING and found[1] == "do":
            return found[0]
        if found:
            self._tell_kinds(found, table)
        elif "retry" in table.entries:
            self._reading.fail(table, "'retry' needs 'do:' or another kind beside it")
        elif "else" in table.entries:
            self._reading.fail(table, f"{ELSE_GOES_WITH}; here neither 'then' nor 'do' is given")
        else:
            strange = next((k for k in table.entries if k not in MODIFIERS), "")
            near = did_you_mean(strange, KINDS)
            what = f"'{strange}' is no kind of node" if strange else "a node needs a kind"
            mark = table.entries[strange].key_mark if strange else table.mark
            self._reading.problems.error(mark, f"{what}{near}")
        return None

    def _tell_kinds(self, found: Sequence[str], table: Table) -> None:
        """Note several kinds at one node, at the one that was written last."""
        repeating = next((kind for kind in found if kind in REPEATING), "")
        cure = "put the nodes into a 'sequence', or into another kind that holds several"
        if repeating:
            cure = f"the body of '{repeating}' stands under 'do:'"
        self._reading.problems.error(
            max(table.entries[kind].key_mark for kind in found),
            f"a node has one kind, here are {' and '.join(found)}; {cure}",
        )

    # --- kinds

    def _composite(self, kind: str) -> Callable[[Table], Kind | None]:
        def read(table: Table) -> Kind | None:
            listing = self._reading.listing(table.entries[kind].value, f"'{kind}'")
            if listing is None:
                return None
            return Composite(kind, tuple(map(self.node, listing.items)))

        return read

    def _parallel(self, table: Table) -> Kind | None:
        listing = self._reading.listing(table.entries["parallel"].value, "'parallel'")
        if listing is None:
            return None
        children, count = tuple(map(self.node, listing.items)), len(listing.items)
        succeed = self._threshold(table, "succeed", count)
        fail = self._threshold(table, "fail", count)
        waits = table.get("wait_for_all")
        wait_for_all = bool(waits and self._reading.truth(waits, "'wait_for_all'"))
        if succeed is None:
            succeed = count if fail is None else count - fail + 1
        if fail is None:
            fail = count - succeed + 1
        elif succeed + fail > count + 1:
            told = (
                f"the parallel has failed before {fail} children have: with {count - succeed + 1} "
                f"failures, {succeed} of {count} can no longer succeed; give 'fail' alone, or a "
                "smaller 'succeed'"
            )
            self._reading.problems.error(table.entries["fail"].key_mark, told)
        return Parallel(children, succeed, fail, wait_for_all)

    def _threshold(self, table: Table, key: str, count: int) -> int | None:
        value = table.get(key)
        if value is None:
            return None
        words = {"all": count, "one": 1}
        word = describe(value).strip("'")
        if word in words:
            return words[word]
        number = self._reading.whole(value, f"'{key}', if not all or one,")
        if number is not None and number > count:
            self._reading.fail(value, f"{number} children are to {key}, and there are {count}")
        return number or count

    def _turned(self, kind: str) -> Callable[[Table], Kind | None]:
        return lambda table: Turned(kind, self.node(table.entries[kind].value))

    def _run(self, table: Table) -> Kind | None:
        value = table.entries["run"].value
        name = describe(value).strip("'")
        if name in self._headers and name not in self._reading.catalogue.behaviour_names():
            self._reading.fail(value, f"'{name}' is a tree: write 'call: {name}'")
            return None
        use = self._leaves.use("run", table)
        return RunLeaf(use) if use else None

    def _check(self, table: Table) -> Kind | None:
        value = table.entries["check"].value
        is_constant = isinstance(value, Scalar) and isinstance(value.value, bool)
        if is_constant or (is_text(value) and "{" in str(value.value)):  # type: ignore[union-attr]
            condition = self._leaves.condition(value, "'check'")
            for key in LEAF_KEYS:
                if key in table.entries:
                    self._reading.problems.error(
                        table.entries[key].key_mark, f"'{key}' belongs to a leaf, not an expression"
                    )
            return CheckKeys(condition) if isinstance(condition, KeyHolds | Computed) else None
        use = self._leaves.use("check", table)
        return CheckLeaf(use) if use else None

    def _wait(self, table: Table) -> Kind | None:
        duration_s = self._reading.seconds(table.entries["wait"].value, "'wait'")
        return Wait(duration_s or 1.0)  # it writes nothing, so the rest is checked all the same

    def _set(self, table: Table) -> Kind | None:
        given = self._reading.table(table.entries["set"].value, "'set'")
        if given is None:
            return None
        if not given.entries:
            self._reading.fail(given, "'set' needs at least one 'key: value'")
            return None
        values: dict[str, Source] = {}
        for key, entry in given.entries.items():
            name = self._reading.checked_name(key, entry.key_mark, "a key")
            source = self._reading.source(entry.value, f"key '{key}'")
            values.update({name: source} if name and source else {})
        return Set(values) if len(values) == len(given.entries) else None

    def _ask(self, table: Table) -> Kind | None:
        return read_ask(table, self._reading)


def _shown_kind(kind: str, table: Table) -> str:
    if kind == "then":
        return "if"
    return "retry" if kind == "do" and "retry" in table.entries else kind
