"""Questions to a node of a description: its conditions, its leaves, whether it needs time."""

from collections.abc import Iterator, Mapping

from executive.tree.language import Tree
from executive.tree.leaf_use import Combined, Condition, LeafUse
from executive.tree.node_kinds import (
    Branch,
    Call,
    CheckKeys,
    CheckLeaf,
    Composite,
    Group,
    Loop,
    Node,
    Parallel,
    RunLeaf,
    Set,
    Switch,
    Turned,
)


def is_instant(node: Node) -> bool:
    """Return whether a node always ends in its first tick; a called tree may need longer."""
    modifiers = node.modifiers
    if modifiers.retry or (modifiers.on_failure and not is_instant(modifiers.on_failure)):
        return False
    if isinstance(node.kind, Composite | Parallel | Turned | Branch | Switch | Group):
        return all(is_instant(child) for child in node.children())
    return isinstance(node.kind, CheckLeaf | CheckKeys | Set)


def conditions_of(node: Node) -> tuple[Condition, ...]:
    """Return the conditions of a node itself."""
    kind, modifiers = node.kind, node.modifiers
    own = None
    if isinstance(kind, Loop):
        own = kind.until
    elif isinstance(kind, Branch):
        own = kind.condition
    if own is modifiers.if_ is modifiers.while_ is None:  # fast path: most nodes have none
        return ()
    return tuple(c for c in (modifiers.if_, modifiers.while_, own) if c is not None)


def asks(node: Node, trees: Mapping[str, Tree]) -> bool:
    """Return whether a node or one below, called trees included, asks any condition."""
    return any(
        isinstance(one.kind, CheckLeaf | CheckKeys | Switch)
        or bool(conditions_of(one))
        or (isinstance(one.kind, Call) and asks(trees[one.kind.tree].root, trees))
        for one in node.walk()
    )


def uses_leaf(name: str, tree: str, trees: Mapping[str, Tree]) -> bool:
    """Return whether a tree, or one that it calls, uses a leaf."""
    return any(
        any(use.name == name for use in uses_of(one))
        or (isinstance(one.kind, Call) and uses_leaf(name, one.kind.tree, trees))
        for one in trees[tree].root.walk()
    )


def leaves_of(condition: Condition) -> Iterator[LeafUse]:
    """Yield the leaves in a condition."""
    if isinstance(condition, LeafUse):
        yield condition
    elif isinstance(condition, Combined):
        for part in condition.parts:
            yield from leaves_of(part)


def uses_of(node: Node) -> Iterator[LeafUse]:
    """Yield the leaves at a node itself, those of its conditions included."""
    for condition in conditions_of(node):
        yield from leaves_of(condition)
    if isinstance(node.kind, RunLeaf | CheckLeaf):
        yield node.kind.use
