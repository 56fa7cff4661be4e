"""Nodes: a mapping with one kind key and modifiers becomes a checked description."""

import re
from collections.abc import Callable, Mapping, Sequence

from executive.errors import did_you_mean
from executive.tree.language import (
    UNREADABLE,
    Ask,
    Attempts,
    Call,
    CheckLeaf,
    Composite,
    ForEach,
    Group,
    Kind,
    Literally,
    Loop,
    Modifiers,
    Node,
    Ref,
    RunLeaf,
    Set,
    Source,
    TypeName,
    Wait,
)
from executive.tree.leaf_reader import LEAF_KEYS, LeafReader, check_port, read_outputs
from executive.tree.problem import Mark
from executive.tree.reading import Reading
from executive.tree.traversal import is_instant
from executive.tree.value import Table, Value, describe

# Each kind and the keys beside it.
KINDS: Mapping[str, tuple[str, ...]] = {
    "sequence": (),
    "fallback": (),
    "reactive_sequence": (),
    "reactive_fallback": (),
    "parallel": ("succeed",),
    "loop": ("do",),
    "for_each": ("do",),
    "run": LEAF_KEYS,
    "check": LEAF_KEYS,
    "wait": (),
    "set": (),
    "ask": ("default",),
    "call": ("in", "out"),
    "do": (),  # with `retry` beside it this is the kind `retry`; a plain `do` carries modifiers
}
MODIFIERS = ("if", "while", "timeout", "retry", "on_failure", "optional", "name")
Ports = Mapping[str, TypeName]
_NAME = re.compile(r"[^/@\n\t]{1,60}")


class NodeReader:
    """Reads nodes; `headers` are the ports of every tree that can be called, by name."""

    def __init__(self, reading: Reading, headers: Mapping[str, tuple[Ports, Ports]]) -> None:
        self._reading = reading
        self._headers = headers
        self._leaves = LeafReader(reading)
        self._kinds: Mapping[str, Callable[[Table], Kind | None]] = {
            **{
                kind: self._composite(kind)
                for kind in KINDS
                if kind.endswith(("sequence", "fallback", "parallel"))
            },
            "loop": self._loop,
            "for_each": self._for_each,
            "run": self._run,
            "check": self._check,
            "wait": self._wait,
            "set": self._set,
            "ask": self._ask,
            "call": self._call,
            "do": self._group,
        }

    def node(self, value: Value) -> Node:
        """Read a node; one with mistakes is reported, and becomes an unreadable node."""
        return self._node(value) or Node(Composite(UNREADABLE, ()), Modifiers(), value.mark)

    def _node(self, value: Value) -> Node | None:
        table = self._node_table(value)
        kind = self._kind_of(table) if table else None
        if table is None or kind is None:
            return None
        allowed = (kind, *KINDS[kind], *MODIFIERS)
        self._reading.known_keys(
            table,
            allowed,
            f"a '{'retry' if kind == 'do' and 'retry' in table.entries else kind}' node",
        )
        what = self._kinds[kind](table)
        modifiers = self._modifiers(table)
        return Node(what, modifiers, table.entries[kind].key_mark) if what is not None else None

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
        found = [kind for kind in KINDS if kind in table.entries]
        if found in (["loop", "do"], ["for_each", "do"]):
            return found[0]
        if len(found) == 1:
            return found[0]
        if found:
            mark = table.entries[found[1]].key_mark
            self._reading.problems.error(
                mark, f"a node has one kind, here are {' and '.join(found)}"
            )
        elif "retry" in table.entries:
            self._reading.fail(table, "'retry' needs 'do:' or another kind beside it")
        else:
            strange = next((k for k in table.entries if k not in MODIFIERS), "")
            near = did_you_mean(strange, KINDS)
            what = f"'{strange}' is no kind of node" if strange else "a node needs a kind"
            mark = table.entries[strange].key_mark if strange else table.mark
            self._reading.problems.error(mark, f"{what}{near}")
        return None

    # --- kinds

    def _composite(self, kind: str) -> Callable[[Table], Kind | None]:
        def read(table: Table) -> Kind | None:
            listing = self._reading.listing(table.entries[kind].value, f"'{kind}'")
            if listing is None:
                return None
            children = tuple(map(self.node, listing.items))
            succeed = self._succeed(table, len(listing.items)) if kind == "parallel" else 0
            if kind == "reactive_sequence":
                self._refuse_slow(children[:-1])
            return Composite(kind, children, succeed)

        return read

    def _refuse_slow(self, earlier: Sequence[Node]) -> None:
        for node in earlier:
            if not is_instant(node):
                told = (
                    f"{node.label} takes time, and a reactive_sequence asks all but its "
                    "last child anew at each tick; "
                )
                self._reading.problems.error(
                    node.mark, told + "put what takes time into one sequence at its end"
                )

    def _succeed(self, table: Table, count: int) -> int:
        value = table.get("succeed")
        words = {"all": count, "one": 1}
        if value is None:
            return count
        word = describe(value).strip("'")
        if word in words:
            return words[word]
        number = self._reading.whole(value, "'succeed', if not all or one,")
        if number is not None and number > count:
            self._reading.fail(value, f"{number} children are to succeed, and there are {count}")
        return number or count

    def _body(self, table: Table, kind: str) -> Node | None:
        body = table.get("do")
        if body is None:
            mark = table.entries[kind].key_mark
            self._reading.problems.error(
                mark, f"'{kind}' needs 'do:' with the node that it repeats"
            )
            return None
        return self.node(body)

    def _group(self, table: Table) -> Kind | None:
        return Group(self.node(table.entries["do"].value))

    def _loop(self, table: Table) -> Kind | None:
        body = self._body(table, "loop")
        given = self._reading.table(table.entries["loop"].value, "'loop'")
        if given is None:
            return None
        self._reading.known_keys(given, ("until", "max"), "'loop'")
        if not given.entries:
            self._reading.fail(given, "'loop' needs 'until' or 'max'")
            return None
        until_value, max_value = given.get("until"), given.get("max")
        until = self._leaves.condition(until_value, "'until'") if until_value is not None else None
        rounds = self._reading.whole(max_value, "'max'") if max_value is not None else None
        return Loop(until, rounds, body) if body and (until or rounds) else None

    def _for_each(self, table: Table) -> Kind | None:
        body = self._body(table, "for_each")
        given = self._reading.table(table.entries["for_each"].value, "'for_each'")
        if given is None:
            return None
        self._reading.known_keys(given, ("item", "in"), "'for_each'")
        item_value, in_value = given.get("item"), given.get("in")
        if item_value is None or in_value is None:
            self._reading.fail(
                given, "'for_each' needs 'item', a name, and 'in', a list or \"{key}\""
            )
            return None
        item, source = (
            self._reading.name(item_value, "'item'"),
            self._reading.source(in_value, "'in'"),
        )
        if isinstance(source, Literally) and not isinstance(source.value, list):
            self._reading.fail(
                in_value, f"'in' takes a list or \"{{key}}\", not {describe(in_value)}"
            )
            return None
        return ForEach(item, source, body) if body and item and source else None

    def _run(self, table: Table) -> Kind | None:
        use = self._leaves.use("run", table)
        return RunLeaf(use) if use else None

    def _check(self, table: Table) -> Kind | None:
        use = self._leaves.use("check", table)
        return CheckLeaf(use) if use else None

    def _wait(self, table: Table) -> Kind | None:
        duration_s = self._reading.seconds(table.entries["wait"].value, "'wait'")
        return Wait(duration_s) if duration_s else None

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
        question = self._reading.text(table.entries["ask"].value, "'ask'")
        default = table.get("default")
        answer = self._reading.truth(default, "'default'") if default is not None else None
        return Ask(question, answer) if question else None

    def _call(self, table: Table) -> Kind | None:
        value = table.entries["call"].value
        tree = self._reading.text(value, "'call'")
        if tree is None:
            return None
        if tree not in self._headers:
            self._reading.fail(value, f"no tree '{tree}'{did_you_mean(tree, self._headers)}")
            return None
        ins, outs = self._headers[tree]
        given = read_outputs(self._reading, table.get("out"), tuple(outs), tree)
        outputs = {port: given.get(port, Ref(port, value.mark, is_listed=False)) for port in outs}
        return Call(
            tree, self._call_inputs(table.get("in"), ins, tree, value.mark), outputs, value.mark
        )

    def _call_inputs(
        self, value: Value | None, ports: Ports, tree: str, mark: Mark
    ) -> dict[str, Source]:
        inputs: dict[str, Source] = {port: Ref(port, mark, is_listed=False) for port in ports}
        table = self._reading.table(value, f"'in' of {tree}") if value is not None else None
        for port, entry in table.entries.items() if table else ():
            if check_port(self._reading, "in", port, entry.key_mark, tuple(ports), tree):
                source = self._reading.source(entry.value, f"port '{port}'")
                inputs.update({port: source} if source else {})
        return inputs

    # --- modifiers

    def _modifiers(self, table: Table) -> Modifiers:
        get, reading = table.get, self._reading
        if_, while_, timeout, retry = get("if"), get("while"), get("timeout"), get("retry")
        recovery, optional, name = get("on_failure"), get("optional"), get("name")
        modifiers = Modifiers(
            if_=None if if_ is None else self._leaves.condition(if_, "'if'"),
            while_=None if while_ is None else self._leaves.condition(while_, "'while'"),
            timeout_s=None if timeout is None else reading.seconds(timeout, "'timeout'"),
            retry=None if retry is None else self._attempts(retry),
            on_failure=None if recovery is None else self.node(recovery),
            optional=bool(optional is not None and reading.truth(optional, "'optional'")),
            name="" if name is None else self._name(name),
        )
        self._refuse_dead(table, modifiers)
        return modifiers

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

    def _refuse_dead(self, table: Table, modifiers: Modifiers) -> None:
        dead = [key for key in ("retry", "on_failure") if key in table.entries]
        if modifiers.optional and dead:
            self._reading.problems.error(
                table.entries["optional"].key_mark,
                f"'optional' is applied inside {' and '.join(map(repr, dead))}, which "
                "would then never see a failure: "
                "give it to a node around this one (optional: true, do: …)",
            )
