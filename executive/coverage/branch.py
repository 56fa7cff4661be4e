"""The branches of a tree: the ends that its nodes can have, and what its modifiers can do."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from py_trees.behaviour import Behaviour

from executive.coverage.ends import Ends, F, ends_of, takes_time
from executive.events.event import Event
from executive.events.node import (
    NodeEnded,
    NodeExcused,
    NodeForbidden,
    NodeLeftOut,
    NodeResult,
    NodeRetried,
    NodeTimedOut,
)
from executive.tree.modifiers import IfNode, OptionalNode, RetryNode, TimeoutNode, WhileNode
from executive.tree.small_nodes import CallNode

ENDS = (NodeResult.SUCCESS, NodeResult.FAILURE, NodeResult.SKIPPED)
HALTED = NodeResult.HALTED
_EFFECTS: dict[type[Event], str] = {
    NodeLeftOut: "left out",
    NodeForbidden: "forbidden",
    NodeTimedOut: "timed out",
    NodeRetried: "retried",
    NodeExcused: "excused",
}


@dataclass(frozen=True, slots=True)
class Branch:
    """One way that a run can take.

    Attributes:
        path: Path of the node, or of its modifier: `main/0:Localise@timeout`.
        what: `success`, `failure`, `skipped` or `halted` of a node; `left out`, `forbidden`, `timed
            out`, `retried` or `excused` of a modifier.
    """

    path: str
    what: str

    def __str__(self) -> str:
        return f"{self.path}: {self.what}"


@dataclass(frozen=True, slots=True)
class Limb:
    """A node of the tree with its modifiers.

    Attributes:
        path: Path of the node.
        name: Its path below the node above it: `0:Localise`, `1:do/0:check`.
        depth: How deep it lies, modifiers not counted.
        branches: What a run can take there.
        calls: The tree that it calls; empty if none.
    """

    path: str
    name: str
    depth: int
    branches: tuple[Branch, ...]
    calls: str


def branch_of(node: str, event: Event) -> Branch | None:
    """Return the branch that an event of a node tells of; None if it tells of none."""
    if isinstance(event, NodeEnded):
        return Branch(node, event.status.value)
    told = _EFFECTS.get(type(event))
    return None if told is None else Branch(node, told)


def limbs_of(root: Behaviour) -> tuple[Limb, ...]:
    """Return the nodes of a tree with their branches, parents first."""
    return tuple(_limbs(root, _all_ends(root), _Above("", 0), []))


@dataclass(frozen=True, slots=True)
class _Above:
    """The node above, by its path, and how deep those below it lie."""

    path: str
    depth: int


def _limbs(
    node: Behaviour, ends: dict[int, Ends], above: _Above, outside: Sequence[Branch]
) -> Iterator[Limb]:
    """Yield the nodes below; `outside` are the branches of the modifiers around this one."""
    own = list(outside)
    if node.is_journalled:
        own += [Branch(node.path, end.value) for end in ENDS if end in ends[id(node)]]
        name = node.path.removeprefix(above.path).removeprefix("/")
        calls = node.tree if isinstance(node, CallNode) else ""
        yield Limb(node.path, name, above.depth, tuple(own), calls)
        own, above = [], _Above(node.path, above.depth + 1)
    else:
        effect = _effect_of(node, ends)
        own += [Branch(node.path, effect)] if effect else []
    for index, child in enumerate(node.children):
        yield from _limbs(child, ends, above, own if index == 0 else ())


def _effect_of(node: Behaviour, ends: dict[int, Ends]) -> str:
    """Return what a modifier can do; empty if nothing, or if the journal cannot tell."""
    inner = ends[id(node.children[0])]
    match node:
        case IfNode() if not node.is_repeated:
            return _EFFECTS[NodeLeftOut]
        case WhileNode() if not node.is_repeated:
            return _EFFECTS[NodeForbidden]
        case TimeoutNode() if takes_time(node.children[0]):
            return _EFFECTS[NodeTimedOut]
        case RetryNode() if F in inner:
            return _EFFECTS[NodeRetried]
        case OptionalNode() if F in inner and not node.is_repeated:
            return _EFFECTS[NodeExcused]
    return ""


def _all_ends(root: Behaviour) -> dict[int, Ends]:
    found: dict[int, Ends] = {}
    for node in root.iterate():  # children first
        found[id(node)] = ends_of(node, [found[id(child)] for child in node.children])
    return found
