"""The names of types in a tree's header: one that no leaf gives or takes is a mistake."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from executive.errors import did_you_mean
from executive.leaf.action import Leaf
from executive.tree.expressions.dimension import NAMED
from executive.tree.expressions.kinds import bare, fields_of, item_of, members, sort_of
from executive.tree.language import Tree, TypeName
from executive.tree.reading import Reading
from executive.tree.traversal import uses_of

_BASIC = frozenset({"bool", "int", "float", "str", "object", "list", "dict", "tuple", "ndarray"})


def check_port_types(trees: Mapping[str, Tree], reading: Reading) -> dict[str, Tree]:
    """Note the types of ports that nothing has; they then stand for any type.

    The leaves that the trees use are looked at first. Only for a name that none of them has, all
    behaviours of the catalogue are imported.
    """
    ports = [port for tree in trees.values() for port in _ports(tree)]
    known = _BASIC | {name.replace(" ", "_") for name in NAMED}
    if not {_item(port) for port in ports} <= known:
        known |= _names_of(use.leaf for tree in trees.values() for use in _uses(tree))
    if not {_item(port) for port in ports} <= known:
        known |= _names_of(leaf for _, leaf in reading.catalogue.behaviours())
    unknown = {port for port in ports if _item(port) not in known}
    for port in unknown:
        told = f"no leaf gives or takes the type '{_item(port)}'{did_you_mean(_item(port), known)}"
        reading.problems.error(port.mark, told)
    if not unknown:
        return dict(trees)
    return {name: _without(tree, unknown) for name, tree in trees.items()}


def _ports(tree: Tree) -> Iterator[TypeName]:
    yield from tree.inputs.values()
    yield from tree.outputs.values()


def _item(port: TypeName) -> str:
    """Return the name without `list[…]`."""
    return port.name.removeprefix("list[").removesuffix("]")


def _uses(tree: Tree) -> Iterator[Any]:
    for node in tree.root.walk():
        yield from uses_of(node)


def _names_of(leaves: Iterable[type[Leaf[Any]]]) -> set[str]:
    """Return the names of the types of ports, of their fields, and of what these derive from."""
    found: set[str] = set()
    seen: set[type] = set()
    waiting: list[Any] = []
    for leaf in leaves:
        waiting += [port.type for port in (*leaf.inputs.values(), *leaf.outputs.values())]
    while waiting:
        for kind in members(waiting.pop()):
            sort, inner = sort_of(kind), bare(kind)
            if sort in ("list", "mapping"):
                waiting.append(item_of(kind))
            elif isinstance(inner, type) and inner not in seen:
                seen.add(inner)
                found.update(one.__name__ for one in inner.__mro__)
                waiting.extend(fields_of(inner).values() if sort == "object" else ())
    return found


def _without(tree: Tree, unknown: set[TypeName]) -> Tree:
    """Return a tree whose unknown types are replaced by any, so that they are told once."""

    def known(ports: Mapping[str, TypeName]) -> dict[str, TypeName]:
        anything = {True: "object?", False: "object"}
        return {
            name: TypeName(anything[port.is_optional], port.mark) if port in unknown else port
            for name, port in ports.items()
        }

    return replace(tree, inputs=known(tree.inputs), outputs=known(tree.outputs))
