"""How a node of a tree can end: by success, by failure, or left out; told by its kind and children.

A leaf, a condition and a question of yes or no can end in both ways. What is told of the other
nodes follows from their rules (docs/node_rules.md). An end that only a mistake causes, such as a
key that was never written, does not count.
"""

from collections.abc import Sequence

from py_trees.behaviour import Behaviour

from executive.events.node import NodeResult
from executive.tree.ask_node import AskNode
from executive.tree.branches import IfElseNode, SwitchNode
from executive.tree.composites import FallbackNode, InOrderNode, ReactiveFallbackNode, ReactiveNode
from executive.tree.leaf_nodes import CheckNode, RunNode
from executive.tree.modifiers import (
    IfNode,
    OnFailureNode,
    OnHaltNode,
    OptionalNode,
    TimeoutNode,
    WhileNode,
)
from executive.tree.parallel import ParallelNode
from executive.tree.repeating import ConsumeNode, ForEachNode, LoopNode
from executive.tree.results import ForceFailureNode, NotNode
from executive.tree.small_nodes import SetNode, WaitNode

Ends = frozenset[NodeResult]
S, F, LEFT_OUT = NodeResult.SUCCESS, NodeResult.FAILURE, NodeResult.SKIPPED
_BOTH, _SUCCESS, _NONE = frozenset({S, F}), frozenset({S}), frozenset[NodeResult]()


def ends_of(node: Behaviour, children: Sequence[Ends]) -> Ends:  # noqa: C901 - a case a kind
    """Return how a node can end.

    Args:
        node: The node; a modifier is a node of its own around another.
        children: How its children can end.
    """
    match node:
        case RunNode() | CheckNode():
            return _BOTH
        case WaitNode() | SetNode():
            return _SUCCESS
        case AskNode():
            return _SUCCESS if node.choices else _BOTH
        case IfNode():
            return children[0] | {LEFT_OUT}
        case WhileNode():
            return children[0] | {F}
        case TimeoutNode():
            return children[0] | ({F} if takes_time(node.children[0]) else _NONE)
        case OptionalNode():
            return _replaced(children[0], F, S)
        case OnFailureNode() | OnHaltNode():
            return children[0]
        case NotNode():
            return frozenset({S: F, F: S}.get(end, end) for end in children[0])
        case ForceFailureNode():
            return _replaced(children[0], S, F)
        case LoopNode():
            return _of_loop(node, children[0])
        case ForEachNode() | ConsumeNode():
            return _SUCCESS | (children[0] & {F})
        case ParallelNode():
            return _of_parallel(node, children)
        case IfElseNode():
            return _union(children) | ({LEFT_OUT} if len(children) == 1 else _NONE)
        case SwitchNode():
            return _union(children) | (_NONE if node.has_otherwise else {F})
        case FallbackNode() | ReactiveFallbackNode():
            return _in_order(children, decides=S, other=F)
    if len(children) == 1 and not isinstance(node, InOrderNode | ReactiveNode):
        return children[0]  # do, call, retry; `once` leaves out only where it is ticked again
    return _in_order(children, decides=F, other=S)


def takes_time(node: Behaviour) -> bool:
    """Return whether a node may run for more than one tick."""
    lasting = (RunNode, WaitNode, AskNode)
    return any(
        isinstance(one, lasting)
        or (isinstance(one, LoopNode) and not (one.has_limit or one.has_until))
        for one in node.iterate()
    )


def _in_order(children: Sequence[Ends], decides: NodeResult, other: NodeResult) -> Ends:
    """Return the ends of a sequence, which a failure decides, or a fallback, which a success does.

    The other end needs a child that ends so, while all others end so or are left out.
    """
    found = {decides} if any(decides in one for one in children) else set()
    if all(one & {other, LEFT_OUT} for one in children) and any(other in one for one in children):
        found.add(other)
    if all(LEFT_OUT in one for one in children):
        found.add(LEFT_OUT)
    return frozenset(found)


def _of_parallel(node: ParallelNode, children: Sequence[Ends]) -> Ends:
    succeed, fail = node.thresholds
    able = {end: sum(end in one for one in children) for end in (S, F, LEFT_OUT)}
    found = {LEFT_OUT} if able[LEFT_OUT] == len(children) else set()
    missing = len(children) - able[S] if succeed == len(children) else 0
    if able[S] and able[S] + min(missing, able[LEFT_OUT]) >= succeed:
        found.add(S)
    if able[F] and able[F] >= min(fail, len(children) - succeed + 1):
        found.add(F)
    return frozenset(found)


def _of_loop(node: LoopNode, body: Ends) -> Ends:
    found = body & {F}
    if node.has_until:
        return found | {S} | ({F} if node.has_limit else _NONE)
    return found | (_SUCCESS if node.has_limit and body & {S, LEFT_OUT} else _NONE)


def _replaced(ends: Ends, one: NodeResult, by: NodeResult) -> Ends:
    return frozenset(by if end is one else end for end in ends)


def _union(ends: Sequence[Ends]) -> Ends:
    return _NONE.union(*ends)
