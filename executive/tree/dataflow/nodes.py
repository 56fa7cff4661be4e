"""Check every key in the order of execution: written before it is read, and of the right type.

A key counts as written as soon as some path to its reader may have written it: what is reported is
a read that must fail. A branch that may be left out (`if`, `optional`, a fallback's alternatives, a
loop's body) adds its types to those that the key had before; a node that surely ran replaces them.
A subtree is followed once for each combination of types that it is called with, so that ports need
not be declared with types to be checked.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Annotated, Any

from executive.tree.dataflow.keys import ANYTHING, TEXT, UNKNOWN, Keys, Types
from executive.tree.dataflow.wires import Wires, mark_of, shown_source
from executive.tree.dataflow.writers import Writers, written_in
from executive.tree.expressions.dimension import PLAIN
from executive.tree.expressions.kinds import bare, dimension_of, known_value, number
from executive.tree.key_source import Ref
from executive.tree.language import Tree
from executive.tree.node_kinds import (
    UNREADABLE,
    Ask,
    Branch,
    Call,
    CheckKeys,
    Composite,
    Consume,
    ForEach,
    Group,
    Kind,
    Loop,
    Node,
    Parallel,
    Set,
    Switch,
    Turned,
)
from executive.tree.port_types import fits_name, item_type, names
from executive.tree.problem import Mark, Problems
from executive.tree.reading import Reading


class Dataflow:
    """Checks the keys of all trees of a mission."""

    def __init__(self, trees: Mapping[str, Tree], reading: Reading) -> None:
        self._trees = trees
        self._problems = reading.problems
        self._catalogue = reading.catalogue
        self._done: dict[tuple[str, frozenset[tuple[str, Types]]], dict[str, Types]] = {}
        self._written_in: dict[str, Mapping[str, Node]] = {}

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
                self.outputs(tree, dict.fromkeys(tree.inputs, UNKNOWN))

    def outputs(self, tree: Tree, given: Mapping[str, Types]) -> Mapping[str, Types]:
        """Follow a tree, once for these types of its inputs; return the types of its outputs."""
        signature = (tree.name, frozenset(given.items()))
        if signature not in self._done:
            self._done[signature] = {}  # a tree that calls itself has been refused before
            keys = Keys(given)
            writers = Writers(frozenset(tree.inputs), self._all_written(tree), self._catalogue)
            wires = Wires(keys, writers, self._problems)
            _TreeFlow(self, self._trees, wires, self._problems).follow(tree)
            self._promised(tree, keys)
            found = {key: keys[key] for key in (*tree.outputs, ANYTHING) if key in keys}
            self._done[signature] = found
        return self._done[signature]

    def _all_written(self, tree: Tree) -> Mapping[str, Node]:
        if tree.name not in self._written_in:
            self._written_in[tree.name] = written_in(tree)
        return self._written_in[tree.name]

    def _promised(self, tree: Tree, after: Mapping[str, Types]) -> None:
        for port, wanted in tree.outputs.items():
            if port not in after:
                if not wanted.is_optional and ANYTHING not in after:
                    self._problems.error(
                        wanted.mark, f"nothing in '{tree.name}' writes its output '{port}'"
                    )
            elif not any(fits_name(one, wanted.name) for one in after[port]):
                self._problems.error(
                    wanted.mark,
                    f"output '{port}' is {wanted.name}, and {names(after[port])} is written",
                )


class _TreeFlow:
    """Follows the nodes of one tree; what was followed shows in the keys."""

    def __init__(
        self, flow: Dataflow, trees: Mapping[str, Tree], wires: Wires, problems: Problems
    ) -> None:
        self._flow = flow
        self._trees = trees
        self._wires = wires
        self._keys = wires.keys
        self._problems = problems

    def follow(self, tree: Tree) -> None:
        """Follow a whole tree, which may end early."""
        point, start = self._keys.point(), self._keys.writes()
        self._node(tree.root)
        self._perhaps(point, start)

    def _perhaps(self, point: int, start: int) -> None:
        """Let what was followed since a point count as one way, and any part of it as another."""
        after = self._keys.rewind(point)
        self._keys.spoil(start)
        self._keys.join(after)

    def _node(self, node: Node) -> None:
        modifiers = node.modifiers
        for condition in (modifiers.if_, modifiers.while_):
            if condition:
                self._wires.condition(condition)
        if modifiers.title:
            self._wires.types(modifiers.title, "'name'")
        point, start = self._keys.point(), self._keys.writes()
        self._kind(node.kind, node.mark)
        for beside in (modifiers.on_failure, modifiers.on_halt):
            if beside:
                self._beside(beside, point, start)
        if modifiers.if_ or modifiers.once or modifiers.optional:
            self._perhaps(point, start)

    def _beside(self, node: Node, point: int, start: int) -> None:
        """Follow what is ticked when a node has failed or is halted."""
        after = self._keys.rewind(point)
        self._keys.spoil(start)
        self._node(node)
        self._keys.rewind(point)
        for key, types in after.items():
            self._keys.change(key, types)

    def _kind(self, kind: Kind, mark: Mark) -> None:  # noqa: C901 - one case a kind
        match kind:
            case Composite():
                self._composite(kind)
            case Parallel():
                self._parallel(kind)
            case Group(child=child) | Turned(child=child):
                self._node(child)
            case Branch(then=then, otherwise=otherwise):
                self._wires.condition(kind.condition)
                self._one_of((then, otherwise), changes=kind.kind == "while")
            case Switch(source=source):
                self._wires.types(source, "'switch'")
                self._one_of((*kind.cases.values(), kind.otherwise), changes=True)
            case Loop():
                self._loop(kind)
            case ForEach() | Consume():
                self._for_each(kind, mark)
            case Set(values=values):
                types = {key: self._wires.types(one, "'set'") for key, one in values.items()}
                self._keys.write(types)
            case Call():
                self._call(kind)
            case CheckKeys(condition=condition):
                self._wires.condition(condition)
            case Ask(question=question, answer=answer):
                self._wires.types(question, "'ask'")
                self._keys.write({answer.key: TEXT} if answer else {})
            case _ if use := getattr(kind, "use", None):
                self._wires.use(use)

    def _composite(self, kind: Composite) -> None:
        if kind.kind == UNREADABLE:  # it may have written anything
            self._keys.write({ANYTHING: UNKNOWN})
        elif kind.kind.endswith("fallback"):
            self._one_of(kind.children, changes=True)
        else:
            for child in kind.children:
                self._node(child)

    def _parallel(self, kind: Parallel) -> None:
        point, start = self._keys.point(), self._keys.writes()
        for child in kind.children:
            self._node(child)
        if not kind.needs_all:
            self._perhaps(point, start)

    def _one_of(self, children: Iterable[Node | None], *, changes: bool) -> None:
        """Follow children of which one is ticked to its end; None stands for doing nothing.

        If the choice changes, as it does in a fallback, the children before have done a part of
        what they do. A key that each child replaces has lost what it held before.
        """
        ends: dict[str, list[Types]] = {}
        start, count = self._keys.writes(), 0
        for child in children:
            if changes:
                self._keys.spoil(start)
            point, start, count = self._keys.point(), self._keys.writes(), count + 1
            if child is not None:
                self._node(child)
            for key, types in self._keys.rewind(point).items():
                ends.setdefault(key, []).append(types)
        for key, several in ends.items():
            types = frozenset[Any]().union(*several)
            if len(several) == count:
                self._keys.change(key, types)
            else:
                self._keys.join({key: types})

    def _loop(self, kind: Loop) -> None:
        if kind.until is None:
            self._node(kind.body)
            return
        self._wires.condition(kind.until)
        point, start = self._keys.point(), self._keys.writes()
        self._node(kind.body)
        self._keys.rewind(point)
        self._keys.spoil(start)

    def _for_each(self, kind: ForEach | Consume, mark: Mark) -> None:
        types = self._wires.types(kind.source, f"'{kind.label}'")
        items = frozenset(item for item in map(item_type, types) if item is not None)
        if types and not items:
            place = mark_of(kind.source, mark)
            self._problems.error(
                place,
                f"'{kind.label}' goes through a list, and {shown_source(kind.source)} holds "
                f"{names(types)}",
            )
        if kind.item in self._keys:
            self._problems.error(
                mark, f"item '{kind.item}' would overwrite the key of that name; take another name"
            )
        point, start = self._keys.point(), self._keys.writes()
        self._keys.change(kind.item, items or UNKNOWN)
        self._node(kind.body)
        self._keys.rewind(point)
        self._keys.spoil(start)

    def _call(self, kind: Call) -> None:
        tree = self._trees.get(kind.tree)
        if tree is None:  # its name was refused
            self._keys.write({ANYTHING: UNKNOWN})
            return
        after = self._flow.outputs(tree, self._given(kind, tree))
        given = {
            port: after.get(port, UNKNOWN)
            for port in tree.outputs
            if port in after or ANYTHING in after
        }
        self._keys.write({kind.outputs[port].key: types for port, types in given.items()})

    def _given(self, kind: Call, tree: Tree) -> dict[str, Types]:
        """Return the types that a call gives to the tree's inputs."""
        inside: dict[str, Types] = {}
        for port, source in kind.inputs.items():
            wanted = tree.inputs[port]
            types = self._wires.input(port, source, wanted.is_optional, kind.tree)
            if types and not any(fits_name(one, wanted.name) for one in types):
                told = (
                    f"input '{port}' of {kind.tree} is {wanted.name}, and {shown_source(source)} "
                    f"holds {names(types)}"
                )
                self._problems.error(mark_of(source, kind.mark), told)
                types = UNKNOWN  # reported once, not again inside
            if types and isinstance(source, Ref):  # values are not followed through many calls
                types = frozenset(map(_of_any_value, types))
            elif types:
                given = f"'call: {kind.tree}' at {mark_of(source, kind.mark)} gives it"
                types = frozenset(_given_by(one, given) for one in types)
            inside.update({} if types is None else {port: types or UNKNOWN})
        return inside


def _of_any_value(kind: Any) -> Any:
    if known_value(kind) is None:
        return kind
    dimension = dimension_of(kind)
    return bare(kind) if dimension in (None, PLAIN) else number(dimension, bare(kind))


def _given_by(kind: Any, given: str) -> Any:
    """Return a type whose value, if it has only one, tells which call gives it."""
    known = known_value(kind)
    if known is None:
        return kind
    notes = (one if one is not known else replace(known, given=given) for one in kind.__metadata__)
    return Annotated[(kind.__origin__, *notes)]
