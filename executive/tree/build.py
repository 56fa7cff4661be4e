"""A checked mission to py_trees nodes, each with a path that is the same on every run.

Paths: the root is `main`; a child is `<parent>/<index>:<name>`; a modifier is `<node>@retry`; a
recovery is `<node>@on_failure/0:<name>`; a condition's leaf is `<node>@if:<name>`.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.leaf.runtime import Runtime
from executive.leaf.store import Store
from executive.tree.composites import FallbackNode, ParallelNode, ReactiveFallbackNode, SequenceNode
from executive.tree.conditions import Answer, build_condition, condition_text
from executive.tree.language import (
    Ask,
    Call,
    CheckLeaf,
    Composite,
    Condition,
    ForEach,
    Group,
    Kind,
    Loop,
    MissionFile,
    Node,
    RunLeaf,
    Set,
    Wait,
)
from executive.tree.leaf_nodes import Asked, CheckNode, RunNode
from executive.tree.modifiers import (
    IfNode,
    OnFailureNode,
    OptionalNode,
    RetryNode,
    TimeoutNode,
    WhileNode,
)
from executive.tree.nodes import TreeNode
from executive.tree.repeating import ForEachNode, LoopNode
from executive.tree.small_nodes import AskNode, CallFrame, CallNode, GroupNode, SetNode, WaitNode
from executive.tree.wiring import Scope


def build_tree(mission: MissionFile, runtime: Runtime) -> Behaviour:
    """Return the root node, which `tick_once` ticks."""
    return _Builder(mission, runtime).node(mission.trees["main"].root, "main", Scope(runtime.store))


def halt(root: Behaviour) -> None:
    """Cancel every running node, leaves first; also after a tick that was cut off."""
    for node in root.iterate():
        node.stop(Status.INVALID)


class _Builder:
    def __init__(self, mission: MissionFile, runtime: Runtime) -> None:
        self._mission = mission
        self._runtime = runtime

    def node(
        self, node: Node, path: str, scope: Scope, left_out: Status = Status.SUCCESS
    ) -> Behaviour:
        """Build a node with its modifiers around it, the last of the list innermost."""
        built = self._kind(node.kind, node.label, path, scope)
        m, runtime = node.modifiers, self._runtime
        if m.optional:
            built = OptionalNode("optional", f"{path}@optional", runtime, built)
        if m.on_failure:
            recovery = self._child(m.on_failure, 0, f"{path}@on_failure", scope)
            built = OnFailureNode("on_failure", f"{path}@on_failure", runtime, built, recovery)
        if m.retry:
            built = RetryNode(f"retry {m.retry.count}", f"{path}@retry", runtime, built, m.retry)
        if m.timeout_s is not None:
            built = TimeoutNode(
                f"timeout {m.timeout_s:g} s", f"{path}@timeout", runtime, built, m.timeout_s
            )
        if m.while_:
            answer = build_condition(m.while_, f"{path}@while", runtime, scope)
            built = WhileNode(
                f"while {condition_text(m.while_)}", f"{path}@while", runtime, built, answer
            )
        if m.if_:
            answer = build_condition(m.if_, f"{path}@if", runtime, scope)
            built = IfNode(
                f"if {condition_text(m.if_)}", f"{path}@if", runtime, built, answer, left_out
            )
        return built

    def _child(
        self, node: Node, index: int, path: str, scope: Scope, left_out: Status = Status.SUCCESS
    ) -> Behaviour:
        return self.node(node, f"{path}/{index}:{node.label}", scope, left_out)

    def _kind(self, kind: Kind, name: str, path: str, scope: Scope) -> Behaviour:  # noqa: C901 - one line a kind
        runtime = self._runtime
        match kind:
            case Composite():
                return self._composite(kind, name, path, scope)
            case Group(child=child):
                return GroupNode(name, path, runtime, [self._child(child, 0, path, scope)])
            case Loop(until=until, max_rounds=rounds, body=body):
                answer = self._until(until, path, scope)
                return LoopNode(
                    name, path, runtime, self._child(body, 0, path, scope), answer, rounds
                )
            case ForEach(body=body):
                return ForEachNode(
                    kind, name, path, runtime, self._child(body, 0, path, scope), scope
                )
            case RunLeaf(use=use):
                return RunNode(use, name, path, runtime, scope)
            case CheckLeaf(use=use):
                return CheckNode(name, path, runtime, Asked(use, path, runtime, scope))
            case Wait(duration_s=duration_s):
                return WaitNode(name, path, runtime, duration_s)
            case Set(values=values):
                return SetNode(name, path, runtime, values, scope)
            case Ask():
                return AskNode(kind, name, path, runtime)
            case Call():
                return self._call(kind, name, path, scope)

    def _until(self, until: Condition | None, path: str, scope: Scope) -> Answer | None:
        return build_condition(until, f"{path}@until", self._runtime, scope) if until else None

    def _composite(self, kind: Composite, name: str, path: str, scope: Scope) -> Behaviour:
        is_fallback = kind.kind.endswith("fallback")
        left_out = Status.FAILURE if is_fallback else Status.SUCCESS
        children = [
            self._child(child, i, path, scope, left_out) for i, child in enumerate(kind.children)
        ]
        if kind.kind == "parallel":
            return ParallelNode(name, path, self._runtime, children, kind.succeed)
        is_reactive = kind.kind.startswith("reactive")
        for child in children[:-1] if is_reactive else ():
            _mark_repeated(child)
        if not is_fallback:
            return SequenceNode(name, path, self._runtime, children, memory=not is_reactive)
        return (ReactiveFallbackNode if is_reactive else FallbackNode)(
            name, path, self._runtime, children
        )

    def _call(self, kind: Call, name: str, path: str, scope: Scope) -> Behaviour:
        tree = self._mission.trees[kind.tree]
        inner = Scope(Store())
        optional = frozenset(port for port, wanted in tree.inputs.items() if wanted.is_optional)
        root = self._child(tree.root, 0, path, inner)
        return CallNode(CallFrame(kind, optional, scope, inner), name, path, self._runtime, root)


def _mark_repeated(child: Behaviour) -> None:
    for node in child.iterate():
        node.is_repeated = True


@dataclass(frozen=True, slots=True)
class NodeState:
    """One node as a person follows it.

    Attributes:
        path: Its path.
        name: Its name.
        depth: How deep it lies, modifiers not counted.
        status: SUCCESS, FAILURE, RUNNING, or INVALID for not ticked.
        feedback: What it has to say; a modifier's words go before the node's own.
        is_worth_showing: It is the root, or its parent is under way.
    """

    path: str
    name: str
    depth: int
    status: str
    feedback: str
    is_worth_showing: bool


def node_states(root: Behaviour) -> tuple[NodeState, ...]:
    """Return the state of every node, parents first; modifiers are part of their node."""
    return tuple(_states(root, 0, "", True))


def _states(node: Behaviour, depth: int, said: str, is_shown: bool) -> Iterator[NodeState]:
    is_plain = not isinstance(node, TreeNode) or node.is_journalled
    feedback = node.feedback_message or (said if node.status is Status.RUNNING else "")
    if is_plain:
        words = (
            f"{said}: {feedback}"
            if said and said not in feedback and feedback not in said
            else feedback or said
        )
        yield NodeState(node.path, node.name, depth, node.status.name, words, is_shown)
        is_shown, depth, said = node.status is Status.RUNNING, depth + 1, ""
    elif isinstance(node, RetryNode):
        said = feedback
    for child in node.children:
        yield from _states(child, depth, said, is_shown)
