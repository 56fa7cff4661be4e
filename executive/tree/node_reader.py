"""Nodes: a mapping with one kind key and modifiers becomes a checked description."""

import re
from collections.abc import Callable, Mapping, Sequence

from executive.errors import did_you_mean
from executive.tree.ask_reader import read_ask
from executive.tree.expressions.syntax import Truth
from executive.tree.instances import USE, read_uses
from executive.tree.key_source import Computed, Literally, Ref, Source, Template
from executive.tree.language import TypeName
from executive.tree.leaf_reader import LEAF_KEYS, LeafReader, check_port, read_outputs
from executive.tree.leaf_use import KeyHolds
from executive.tree.node_kinds import (
    UNREADABLE,
    Attempts,
    Branch,
    Call,
    CheckKeys,
    CheckLeaf,
    Composite,
    Consume,
    ForEach,
    Group,
    Kind,
    Loop,
    Modifiers,
    Node,
    Parallel,
    RunLeaf,
    Set,
    Switch,
    Turned,
    Wait,
)
from executive.tree.problem import Mark
from executive.tree.reading import Reading, is_text, place_of
from executive.tree.traversal import is_instant
from executive.tree.value import Scalar, Table, Value, describe, without

# Each kind and the keys beside it.
KINDS: Mapping[str, tuple[str, ...]] = {
    "sequence": (),
    "fallback": (),
    "reactive_sequence": (),
    "reactive_fallback": (),
    "persistent_sequence": (),
    "parallel": ("succeed", "fail", "wait_for_all"),
    "not": (),
    "force_failure": (),
    "then": ("if", "else"),
    "switch": ("cases", "else"),
    "loop": ("do",),
    "for_each": ("do",),
    "consume": ("do",),
    "run": LEAF_KEYS,
    "check": LEAF_KEYS,
    "wait": (),
    "set": (),
    "ask": ("default", "choices", "out"),
    "call": ("in", "out", USE),
    "do": ("else",),  # with `while` and `else` a kind of its own; else it carries modifiers
}
SKIP = "skip"  # as an `else`: the node is left out
REPEATING = ("loop", "for_each", "consume")  # beside them, `do` is their body
MODIFIERS = (
    "if",
    "once",
    "while",
    "timeout",
    "retry",
    "on_failure",
    "optional",
    "on_halt",
    "name",
)
Ports = Mapping[str, TypeName]
_ELSE = "'else' goes with 'if' and 'then', with 'while' and 'do', or with 'switch' and 'cases'"
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
                if kind.endswith(("sequence", "fallback"))
            },
            "parallel": self._parallel,
            "not": self._turned("not"),
            "force_failure": self._turned("force_failure"),
            "then": self._if_else,
            "switch": self._switch,
            "loop": self._loop,
            "for_each": self._for_each,
            "consume": self._consume,
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
        if "else" in table.entries and "else" not in allowed:
            self._reading.problems.error(table.entries["else"].key_mark, _ELSE)
        self._reading.known_keys(
            without(table, ["else"]), allowed, f"a '{_shown_kind(kind, table)}' node"
        )
        what = self._kinds[kind](table)
        modifiers = self._modifiers(table, what)
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
        if len(found) == 2 and found[0] in REPEATING and found[1] == "do":
            return found[0]
        if len(found) == 1:
            return found[0]
        if found:
            self._tell_kinds(found, table)
        elif "retry" in table.entries:
            self._reading.fail(table, "'retry' needs 'do:' or another kind beside it")
        elif "else" in table.entries:
            self._reading.fail(table, f"{_ELSE}; here neither 'then' nor 'do' is given")
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

    def _if_else(self, table: Table) -> Kind | None:
        then, asked = self.node(table.entries["then"].value), table.get("if")
        otherwise = self._otherwise(table)
        if asked is None:
            mark = table.entries["then"].key_mark
            self._reading.problems.error(mark, "'then' needs 'if:' with the condition")
            return None
        condition = self._leaves.condition(asked, "'if'")
        return Branch("if", condition, then, otherwise) if condition else None

    def _otherwise(self, table: Table) -> Node | None:
        value = table.get("else")
        if value is not None and is_text(value) and describe(value).strip("'") == SKIP:
            always, never = (Computed(Truth(one), place_of(value)) for one in (True, False))
            return Node(CheckKeys(always), Modifiers(if_=never), value.mark)
        return None if value is None else self.node(value)

    def _switch(self, table: Table) -> Kind | None:
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
        cases = {name: self.node(entry.value) for name, entry in listed.entries.items()}
        return Switch(source, cases, otherwise) if source else None

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
        body, otherwise = self.node(table.entries["do"].value), self._otherwise(table)
        if otherwise is None:
            return Group(body)
        asked = table.get("while")
        if asked is None:
            self._reading.problems.error(table.entries["else"].key_mark, _ELSE)
            return None
        condition = self._leaves.condition(asked, "'while'")
        return Branch("while", condition, body, otherwise) if condition else None

    def _loop(self, table: Table) -> Kind | None:
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

    def _consume(self, table: Table) -> Kind | None:
        body = self._body(table, "consume")
        given = self._reading.table(table.entries["consume"].value, "'consume'")
        if given is None:
            return None
        self._reading.known_keys(given, ("item", "from"), "'consume'")
        item_value, from_value = given.get("item"), given.get("from")
        if item_value is None or from_value is None:
            told = "'consume' needs 'item', a name, and 'from', the \"{key}\" of a list"
            self._reading.fail(given, told)
            return None
        item = self._reading.name(item_value, "'item'")
        source = self._reading.reference(from_value, "'from'")
        return Consume(item, source, body) if body and item and source else None

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

    def _call(self, table: Table) -> Kind | None:
        value = table.entries["call"].value
        tree = self._reading.text(value, "'call'")
        if tree is None:
            return None
        if tree not in self._headers:
            if not self._reading.problems.is_partial:
                self._reading.fail(value, f"no tree '{tree}'{did_you_mean(tree, self._headers)}")
            return None
        ins, outs = self._headers[tree]
        given = read_outputs(self._reading, table.get("out"), tuple(outs), tree)
        outputs = {port: given.get(port, Ref(port, value.mark, is_listed=False)) for port in outs}
        inputs = self._call_inputs(table.get("in"), ins, tree, value.mark)
        use = table.get(USE)
        uses = {} if use is None else read_uses(self._reading, use, tree, None)
        return Call(tree, inputs, outputs, value.mark, uses)

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

    def _modifiers(self, table: Table, kind: Kind | None) -> Modifiers:
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
            on_failure=None if recovery is None else self.node(recovery),
            optional=bool(optional is not None and reading.truth(optional, "'optional'")),
            on_halt=None if on_halt is None else self._on_halt(on_halt),
            name="" if name is None else self._name(name),
            title=None if name is None else self._title(name),
        )
        self._refuse_dead(table, modifiers)
        return modifiers

    def _on_halt(self, value: Value) -> Node:
        node = self.node(value)
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


def _shown_kind(kind: str, table: Table) -> str:
    if kind == "then":
        return "if"
    return "retry" if kind == "do" and "retry" in table.entries else kind
