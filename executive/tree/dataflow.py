"""Check every key in the order of execution: written before it is read, and of the right type.

A key counts as written as soon as some path to its reader may have written it: what is reported is
a read that must fail. A branch that may be left out (`if`, `optional`, a fallback's alternatives, a
loop's body) adds its types to those that the key had before; a node that surely ran replaces them.
A subtree is followed once for each combination of types that it is called with, so that ports need
not be declared with types to be checked.
"""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any

from executive.errors import did_you_mean
from executive.leaf.port import Port
from executive.leaf.store import Store
from executive.tree.expressions.checking import Typing, asked_for
from executive.tree.expressions.dimension import PLAIN
from executive.tree.expressions.evaluation import evaluate
from executive.tree.expressions.functions import shown
from executive.tree.expressions.kinds import (
    Known,
    bare,
    dimension_of,
    known_value,
    measured,
    number,
)
from executive.tree.expressions.syntax import Key, Number, keys_of
from executive.tree.language import (
    UNREADABLE,
    Ask,
    Branch,
    Call,
    CheckKeys,
    Combined,
    Composite,
    Computed,
    Condition,
    Consume,
    ForEach,
    Group,
    KeyHolds,
    Kind,
    LeafUse,
    Literally,
    Loop,
    Node,
    Parallel,
    Ref,
    Set,
    Source,
    Switch,
    Template,
    Tree,
    Turned,
)
from executive.tree.place import Place
from executive.tree.port_types import fits, fits_name, item_type, names, type_name, type_of
from executive.tree.problem import Mark, Problems
from executive.tree.setting_types import field_type, refusal, setting_name, suits_setting
from executive.tree.traversal import uses_of

Types = frozenset[Any]
Keys = Mapping[str, Types]  # the types that each key may hold now


_UNKNOWN: Types = frozenset({Any})
_TEXT: Types = frozenset({str})
_ANYTHING = "*"  # means every key, after a node that could not be read


class Dataflow:
    """Checks the keys of all trees of a mission."""

    def __init__(self, trees: Mapping[str, Tree], problems: Problems) -> None:
        self._trees = trees
        self._problems = problems
        self._done: dict[tuple[str, frozenset[tuple[str, Types]]], Keys] = {}
        self._writes: list[
            tuple[str, Types]
        ] = []  # every write so far, to know what a failed node may have written
        self._inputs: frozenset[str] = frozenset()  # of the present tree
        self._later: frozenset[str] = frozenset()  # every key that the present tree writes anywhere

    def check(self) -> None:
        """Follow `main`, and then every tree that nothing calls."""
        called = {
            n.kind.tree
            for t in self._trees.values()
            for n in t.root.walk()
            if isinstance(n.kind, Call)
        }
        for name, tree in self._trees.items():
            if name == "main" or name not in called:
                self._tree(tree, dict.fromkeys(tree.inputs, _UNKNOWN))

    def _tree(self, tree: Tree, keys: Keys) -> Keys:
        signature = (tree.name, frozenset(keys.items()))
        if signature not in self._done:
            self._done[signature] = {}  # a tree that calls itself has been refused before
            outer = self._later, self._writes, self._inputs
            self._inputs = frozenset(tree.inputs)
            self._later, self._writes = _written_in(tree) | frozenset(keys), []
            after = self._node(tree.root, keys)
            after = _joined(after, self._spoiled(keys, 0))
            self._later, self._writes, self._inputs = outer
            self._promised(tree, after)
            self._done[signature] = after
        return self._done[signature]

    def _promised(self, tree: Tree, after: Keys) -> None:
        for port, wanted in tree.outputs.items():
            if port not in after:
                if not wanted.is_optional and _ANYTHING not in after:
                    self._problems.error(
                        wanted.mark, f"nothing in '{tree.name}' writes its output '{port}'"
                    )
            elif not any(fits_name(one, wanted.name) for one in after[port]):
                self._problems.error(
                    wanted.mark,
                    f"output '{port}' is {wanted.name}, and {names(after[port])} is written",
                )

    # --- nodes

    def _node(self, node: Node, keys: Keys) -> Keys:
        modifiers = node.modifiers
        for condition in (modifiers.if_, modifiers.while_):
            keys = self._condition(condition, keys) if condition else keys
        if modifiers.title:
            self._types(modifiers.title, keys, "'name'")
        start = len(self._writes)
        after = self._kind(node.kind, keys, node.mark)
        for beside in (modifiers.on_failure, modifiers.on_halt):
            if beside:
                self._node(beside, self._spoiled(keys, start))
        if modifiers.if_ or modifiers.once or modifiers.optional:
            return _joined(after, self._spoiled(keys, start))
        return after

    def _kind(self, kind: Kind, keys: Keys, mark: Mark) -> Keys:  # noqa: C901 - one case a kind
        if isinstance(kind, Composite):
            return self._composite(kind, keys)
        if isinstance(kind, Parallel):
            return self._parallel(kind, keys)
        if isinstance(kind, Group | Turned):
            return self._node(kind.child, keys)
        if isinstance(kind, Branch):
            keys = self._condition(kind.condition, keys)
            both = (kind.then, kind.otherwise)
            return self._one_of(both, keys, changes=kind.kind == "while")
        if isinstance(kind, Switch):
            self._types(kind.source, keys, "'switch'")
            return self._one_of((*kind.cases.values(), kind.otherwise), keys, changes=True)
        if isinstance(kind, Loop):
            return self._loop(kind, keys)
        if isinstance(kind, ForEach | Consume):
            return self._for_each(kind, keys, mark)
        if isinstance(kind, Set):
            return self._written(
                keys, {key: self._types(one, keys, "'set'") for key, one in kind.values.items()}
            )
        if isinstance(kind, Call):
            return self._call(kind, keys)
        if isinstance(kind, CheckKeys):
            return self._condition(kind.condition, keys)
        if isinstance(kind, Ask):
            self._types(kind.question, keys, "'ask'")
            return self._written(keys, {kind.answer.key: _TEXT} if kind.answer else {})
        use = getattr(kind, "use", None)
        return self._use(use, keys) if use else keys

    def _composite(self, kind: Composite, keys: Keys) -> Keys:
        if kind.kind == UNREADABLE:  # it may have written anything
            return self._written(keys, {_ANYTHING: _UNKNOWN})
        if kind.kind.endswith("fallback"):
            return self._fallback(kind, keys)
        return self._in_order(kind.children, keys)

    def _in_order(self, children: Iterable[Node], keys: Keys) -> Keys:
        for child in children:
            keys = self._node(child, keys)
        return keys

    def _parallel(self, kind: Parallel, keys: Keys) -> Keys:
        start = len(self._writes)
        after = self._in_order(kind.children, keys)
        return after if kind.needs_all else _joined(after, self._spoiled(keys, start))

    def _one_of(self, children: Iterable[Node | None], keys: Keys, *, changes: bool) -> Keys:
        """Follow children of which one is ticked; if the choice changes, another one has begun."""
        start, ends = len(self._writes), list[Keys]()
        for child in children:
            before = self._spoiled(keys, start) if changes else keys
            ends.append(before if child is None else self._node(child, before))
        after = ends[0]
        for end in ends[1:]:
            after = _joined(after, end)
        return after

    def _fallback(self, kind: Composite, keys: Keys) -> Keys:
        ends: Keys | None = None
        for child in kind.children:
            start = len(self._writes)
            after = self._node(child, keys)
            ends = after if ends is None else _joined(ends, after)
            keys = self._spoiled(keys, start)
        return ends or keys

    def _loop(self, kind: Loop, keys: Keys) -> Keys:
        if kind.until is None:
            return self._node(kind.body, keys)
        keys = self._condition(kind.until, keys)
        start = len(self._writes)
        self._node(kind.body, keys)
        return self._spoiled(keys, start)

    def _for_each(self, kind: ForEach | Consume, keys: Keys, mark: Mark) -> Keys:
        types = self._types(kind.source, keys, f"'{kind.label}'")
        items = frozenset(item for item in map(item_type, types) if item is not None)
        if types and not items:
            place = _mark(kind.source, mark)
            self._problems.error(
                place,
                f"'{kind.label}' goes through a list, and {_shown(kind.source)} holds "
                f"{names(types)}",
            )
        if kind.item in keys:
            self._problems.error(
                mark, f"item '{kind.item}' would overwrite the key of that name; take another name"
            )
        start = len(self._writes)
        self._node(kind.body, {**keys, kind.item: items or _UNKNOWN})
        return self._spoiled(keys, start)

    def _call(self, kind: Call, keys: Keys) -> Keys:
        tree = self._trees.get(kind.tree)
        if tree is None:  # its name was refused
            return self._written(keys, {_ANYTHING: _UNKNOWN})
        inside: dict[str, Types] = {}
        for port, source in kind.inputs.items():
            wanted = tree.inputs[port]
            types = self._input(port, source, keys, wanted.is_optional, kind.tree)
            if types and not any(fits_name(one, wanted.name) for one in types):
                place = _mark(source, kind.mark)
                told = (
                    f"input '{port}' of {kind.tree} is {wanted.name}, and {_shown(source)} "
                    f"holds {names(types)}"
                )
                self._problems.error(place, told)
                types = _UNKNOWN  # reported once, not again inside
            if types and isinstance(source, Ref):  # values are not followed through many calls
                types = frozenset(map(_of_any_value, types))
            inside.update({} if types is None else {port: types or _UNKNOWN})
        after = self._tree(tree, inside)
        given = {
            port: after.get(port, _UNKNOWN)
            for port in tree.outputs
            if port in after or _ANYTHING in after
        }
        return self._written(keys, {kind.outputs[port].key: types for port, types in given.items()})

    # --- leaves and conditions

    def _condition(self, condition: Condition, keys: Keys) -> Keys:
        if isinstance(condition, LeafUse):
            start = len(self._writes)
            return _joined(self._use(condition, keys), self._spoiled(keys, start))
        if isinstance(condition, Combined):
            for part in condition.parts:
                keys = self._condition(part, keys)
            return keys
        if isinstance(condition, Computed):
            types = self._typing(condition.place, keys, "the condition").truth(condition.expression)
            return self._narrowed(condition, keys) if types else keys
        return self._truth(condition, keys)

    def _narrowed(self, condition: Computed, keys: Keys) -> Keys:
        """Return the keys with those that the condition has asked for with `has`."""
        paths = asked_for(condition.expression, True)
        asked = {key.name for key in keys_of(condition.expression) if str(key) in paths}
        return {**dict.fromkeys(asked - set(keys), _UNKNOWN), **keys}

    def _truth(self, condition: KeyHolds, keys: Keys) -> Keys:
        types = self._types(Ref(condition.key, condition.mark), keys, "the condition")
        if types and not any(fits(one, bool) for one in types):
            told = f"a condition needs true or false, and {{{condition.key}}} holds {names(types)}"
            self._problems.error(condition.mark, told)
        return keys

    def _use(self, use: LeafUse, keys: Keys) -> Keys:
        for port, spec in use.leaf.inputs.items():
            types = self._input(port, use.inputs[port], keys, spec.optional, use.name)
            kind = measured(spec.type, port, spec.doc)
            if types and not any(fits(one, kind) for one in types):
                source = use.inputs[port]
                told = (
                    f"input '{port}' of {use.name} is {type_name(kind)}, and "
                    f"{_shown(source)} holds {names(types)}"
                )
                self._problems.error(_mark(source, use.mark), told)
        self._parameters(use, keys)
        for port, ref in use.outputs.items():
            wanted: Port = use.leaf.outputs[port]
            types = frozenset({measured(wanted.type, port, wanted.doc)})
            written = self._written(keys, {ref.key: types})
            keys = _joined(keys, written) if wanted.optional else written
        return keys

    def _parameters(self, use: LeafUse, keys: Keys) -> None:
        for name, source in (use.parameters.sources if use.parameters else {}).items():
            what = f"setting '{name}' of {use.name}"
            types = self._types(source, keys, what)
            wanted = field_type(use.leaf.Settings.model_fields[name])
            if types and not any(suits_setting(one, wanted) for one in types):
                got = " or ".join(sorted({shown(one) for one in types}))
                told = f"{what} is {setting_name(wanted)}, and {_shown(source)} is {got}"
                self._problems.error(source.mark, told)
            elif isinstance(source, Ref):
                self._values(use, name, source, types)

    def _values(self, use: LeafUse, name: str, source: Ref, types: Types) -> None:
        """Report a setting whose value is known before the start and out of bounds."""
        known = [known_value(one) for one in types]
        refused = [(one.value, refusal(use.leaf.Settings, name, one.value)) for one in known if one]
        if refused and len(refused) == len(known) and all(told for _, told in refused):
            value, told = refused[0]
            self._problems.error(
                source.mark,
                f"setting '{name}' of {use.name}: {told[:1].lower()}{told[1:]}, and key "
                f"'{source.key}' is {value!r}",
            )

    def _input(
        self, port: str, source: Source, keys: Keys, is_optional: bool, owner: str
    ) -> Types | None:
        is_absent = isinstance(source, Ref) and source.key not in keys
        if is_absent and is_optional and (not source.is_listed or source.key in self._later):  # type: ignore[union-attr]
            return None
        return self._types(source, keys, f"input '{port}' of {owner}")

    def _types(self, source: Source, keys: Keys, reader: str) -> Types:
        if isinstance(source, Literally):
            kind = type_of(source.value)
            return frozenset({_exactly(kind, source.value)})
        if isinstance(source, Computed):
            types = self._typing(source.place, keys, reader).types(source.expression)
            if isinstance(source.expression, Number):
                value = evaluate(source.expression, Store())
                types = frozenset(_exactly(kind, value) for kind in types)
            return types
        if isinstance(source, Template):
            typing = self._typing(source.place, keys, reader)
            for part in source.parts:
                if not isinstance(part, str):
                    typing.types(part)
            return frozenset({str})
        if source.key in keys or _ANYTHING in keys:
            return keys.get(source.key, _UNKNOWN)
        told = f"{reader} reads key '{source.key}' before it is written"
        known = did_you_mean(source.key, keys) if keys else "; nothing is written before it"
        cure = "; it is written only later" if source.key in self._later else known
        if source.key in self._inputs:
            cure = f"; a call leaves this input out: ask 'has({{{source.key}}})' before"
        self._problems.error(source.mark, told + cure)
        return frozenset()

    def _typing(self, place: Place, keys: Keys, reader: str) -> Typing:
        """Return what finds the types of an expression with these keys."""

        def types_of(key: Key, may_miss: bool) -> Types:
            is_absent = key.name not in keys and _ANYTHING not in keys
            if may_miss and is_absent and key.name in self._later | self._inputs:
                return _UNKNOWN
            return self._types(Ref(key.name, place.at(key.at)), keys, reader)

        def fail(at: int, message: str) -> None:
            self._problems.error(place.at(at), f"{reader}: {message}")

        return Typing(types_of, fail)

    # --- keys

    def _written(self, keys: Keys, new: Mapping[str, Types]) -> Keys:
        self._writes.extend(new.items())
        return {**keys, **{key: types or _UNKNOWN for key, types in new.items()}}

    def _spoiled(self, keys: Keys, start: int) -> Keys:
        """Return what may hold if the nodes since `start` wrote any part of what they write."""
        for key, types in self._writes[start:]:
            keys = _joined(keys, {key: types or _UNKNOWN})
        return keys


def _exactly(kind: Any, value: Any) -> Any:
    """Return a type with its only value; lists are not followed item by item."""
    return Annotated[kind, Known(value)] if isinstance(value, bool | int | float | str) else kind


def _of_any_value(kind: Any) -> Any:
    if known_value(kind) is None:
        return kind
    dimension = dimension_of(kind)
    return bare(kind) if dimension in (None, PLAIN) else number(dimension, bare(kind))


def _joined(one: Keys, other: Keys) -> Keys:
    return {
        key: one.get(key, frozenset()) | other.get(key, frozenset()) for key in {**one, **other}
    }


def _shown(source: Source) -> str:
    if isinstance(source, Literally):
        return repr(source.value)
    return f"key '{source.key}'" if isinstance(source, Ref) else f"'{source}'"


def _mark(source: Source, otherwise: Mark) -> Mark:
    return otherwise if isinstance(source, Literally) else source.mark


def _written_in(tree: Tree) -> frozenset[str]:
    keys: set[str] = set()
    for node in tree.root.walk():
        keys.update(ref.key for use in uses_of(node) for ref in use.outputs.values())
        if isinstance(node.kind, Call):
            keys.update(ref.key for ref in node.kind.outputs.values())
        elif isinstance(node.kind, Set):
            keys.update(node.kind.values)
        elif isinstance(node.kind, ForEach | Consume):
            keys.add(node.kind.item)
        elif isinstance(node.kind, Ask) and node.kind.answer:
            keys.add(node.kind.answer.key)
    return frozenset(keys)
