"""Reads the trees of a mission: headers first, then the bodies of those that are reached."""

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from executive.tree.call_reader import Ports
from executive.tree.language import Tree, TypeName
from executive.tree.node_kinds import Call, Node
from executive.tree.node_reader import NodeReader
from executive.tree.port_types import is_type_name
from executive.tree.problem import Mark
from executive.tree.reading import Reading
from executive.tree.value import Table, Value

_HEADER = ("in", "out")


@dataclass(frozen=True, slots=True)
class Draft:
    """A tree whose ports are known and whose body is not read yet."""

    name: str
    mark: Mark
    body: Value
    inputs: Ports
    outputs: Ports


def read_trees(own: Table | None, libraries: Iterable[Table], reading: Reading) -> dict[str, Tree]:
    """Read the mission's own trees, and those of the libraries that they call, directly or not.

    A mission's own tree goes before one of a library, and a library beside the mission before a
    shipped one.
    """
    drafts: dict[str, Draft] = {}
    for table in libraries:
        drafts.update(_drafts(table, reading))
    mine = _drafts(own, reading) if own else {}
    drafts.update(mine)
    reader = NodeReader(
        reading, {name: (draft.inputs, draft.outputs) for name, draft in drafts.items()}
    )
    trees: dict[str, Tree] = {}
    waiting = deque(mine)
    while waiting:
        name = waiting.popleft()
        if name not in trees:
            draft = drafts[name]
            trees[name] = Tree(name, _root(draft, reader), draft.inputs, draft.outputs, draft.mark)
            waiting.extend(_calls(trees[name].root))
    _check_main(mine, own, reading)
    _tell_unused(mine, trees, reading)
    return trees


def _drafts(table: Table, reading: Reading) -> dict[str, Draft]:
    drafts: dict[str, Draft] = {}
    for name, entry in table.entries.items():
        body = reading.table(entry.value, f"tree '{name}'")
        if reading.checked_name(name, entry.key_mark, "a tree's name") and body:
            inputs, outputs = (_ports(body.get(side), name, reading) for side in _HEADER)
            drafts[name] = Draft(name, entry.key_mark, body, inputs, outputs)
    return drafts


def _ports(value: Value | None, tree: str, reading: Reading) -> Ports:
    table = reading.table(value, f"a port list of tree '{tree}'") if value is not None else None
    ports: dict[str, TypeName] = {}
    for port, entry in table.entries.items() if table else ():
        text = reading.text(entry.value, f"the type of port '{port}'")
        if text is not None and not is_type_name(text):
            cure = (
                "; these are the tree's ports: put a node with wires into a sequence"
                if "{" in text
                else ""
            )
            told = (
                f"port '{port}' takes a type such as Stone, list[Stone] or Stone?, not "
                f"'{text}'{cure}"
            )
            reading.fail(entry.value, told)
        elif text is not None and reading.checked_name(port, entry.key_mark, "a port's name"):
            ports[port] = TypeName(text, entry.value.mark)
    return ports


def _root(draft: Draft, reader: NodeReader) -> Node:
    body = draft.body
    if isinstance(
        body, Table
    ):  # `in` and `out` of a tree are its ports, never the wiring of its root
        body = Table(
            {key: entry for key, entry in body.entries.items() if key not in _HEADER}, body.mark
        )
    return reader.node(body)


def _calls(root: Node) -> list[str]:
    return [node.kind.tree for node in root.walk() if isinstance(node.kind, Call)]


def _check_main(mine: Mapping[str, Draft], own: Table | None, reading: Reading) -> None:
    if own is None:
        return
    if "main" not in own.entries and reading.problems.is_partial:
        return
    if "main" not in own.entries:
        reading.fail(own, "'trees' needs a tree 'main', where the mission begins")
    elif "main" in mine:
        for port in (*mine["main"].inputs.values(), *mine["main"].outputs.values()):
            reading.problems.error(port.mark, "'main' has no ports: nothing calls it")


def _tell_unused(mine: Mapping[str, Draft], trees: Mapping[str, Tree], reading: Reading) -> None:
    reached, waiting = {"main"}, ["main"]
    while waiting:
        tree = trees.get(waiting.pop())
        new = [name for name in (_calls(tree.root) if tree else ()) if name not in reached]
        reached.update(new)
        waiting.extend(new)
    for name, draft in mine.items():
        if name not in reached:
            reading.problems.warning(draft.mark, f"nothing calls tree '{name}'")
