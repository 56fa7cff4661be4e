"""A checked mission to py_trees nodes, each with a path that is the same on every run.

Paths: the root is `main`; a child is `<parent>/<index>:<name>`; a modifier is `<node>@retry`; a
recovery is `<node>@on_failure/0:<name>`; a condition's leaf is `<node>@if:<name>`.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.leaf.runtime import Runtime
from executive.leaf.store import Store
from executive.tree.ask_node import AskNode
from executive.tree.branches import IfElseNode, SwitchNode, WhileElseNode
from executive.tree.composites import (
    FallbackNode,
    PersistentSequenceNode,
    ReactiveFallbackNode,
    ReactiveSequenceNode,
    SequenceNode,
)
from executive.tree.conditions import Answer, build_condition, condition_text
from executive.tree.language import MissionFile
from executive.tree.leaf_nodes import Asked, CheckNode, RunNode
from executive.tree.leaf_use import Condition
from executive.tree.modifiers import (
    IfNode,
    OnceNode,
    OnFailureNode,
    OnHaltNode,
    OptionalNode,
    RetryNode,
    TimeoutNode,
    WhileNode,
)
from executive.tree.node_kinds import (
    Ask,
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
    Node,
    Parallel,
    RunLeaf,
    Set,
    Switch,
    Turned,
    Wait,
)
from executive.tree.nodes import TreeNode
from executive.tree.parallel import ParallelNode
from executive.tree.repeating import ConsumeNode, ForEachNode, LoopNode
from executive.tree.results import ForceFailureNode, NotNode
from executive.tree.rounds import Rounds
from executive.tree.small_nodes import CallFrame, CallNode, GroupNode, SetNode, WaitNode
from executive.tree.traversal import asks
from executive.tree.wiring import Scope, title_of


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
        self._rounds = Rounds()

    def node(self, node: Node, path: str, scope: Scope) -> Behaviour:
        """Build a node with its modifiers around it, the last of the list innermost."""
        built = self._kind(node.kind, node.label, path, scope)
        built.described = node.kind
        m, runtime = node.modifiers, self._runtime
        if m.title is not None and isinstance(built, TreeNode):
            built.title = partial(title_of, m.title, scope)
        if m.on_halt:
            cleanup = self._child(m.on_halt, 0, f"{path}@on_halt", scope)
            built = OnHaltNode("on_halt", f"{path}@on_halt", runtime, built, cleanup)
        if m.optional:
            built = OptionalNode("optional", f"{path}@optional", runtime, built)
        if m.on_failure:
            recovery = self._child(m.on_failure, 0, f"{path}@on_failure", scope)
            place, is_retried = f"{path}@on_failure", m.retry is not None
            built = OnFailureNode(
                "on_failure", place, runtime, built, recovery, is_retried=is_retried
            )
        if m.retry:
            name = f"retry {m.retry.count}"
            built = RetryNode(name, f"{path}@retry", runtime, built, m.retry, self._rounds)
        if m.timeout_s is not None:
            built = TimeoutNode(
                f"timeout {m.timeout_s:g} s", f"{path}@timeout", runtime, built, m.timeout_s
            )
        if m.while_:
            answer = build_condition(m.while_, f"{path}@while", runtime, scope)
            built = WhileNode(
                f"while {condition_text(m.while_)}", f"{path}@while", runtime, built, answer
            )
        if m.once:
            built = OnceNode("once", f"{path}@once", runtime, built)
        if m.if_:
            answer = build_condition(m.if_, f"{path}@if", runtime, scope)
            built = IfNode(f"if {condition_text(m.if_)}", f"{path}@if", runtime, built, answer)
        return built

    def _child(self, node: Node, index: int, path: str, scope: Scope) -> Behaviour:
        return self.node(node, f"{path}/{index}:{node.label}", scope)

    def _children(self, nodes: Iterable[Node], path: str, scope: Scope) -> list[Behaviour]:
        return [self._child(node, index, path, scope) for index, node in enumerate(nodes)]

    def _kind(self, kind: Kind, name: str, path: str, scope: Scope) -> Behaviour:  # noqa: C901 - one line a kind
        runtime = self._runtime
        match kind:
            case Composite():
                return self._composite(kind, name, path, scope)
            case Parallel(children=nodes):
                children = self._children(nodes, path, scope)
                return ParallelNode(name, path, runtime, children, kind)
            case Turned(kind=how, child=child):
                turned = NotNode if how == "not" else ForceFailureNode
                return turned(name, path, runtime, [self._child(child, 0, path, scope)])
            case Branch():
                return self._branch(kind, name, path, scope)
            case Switch():
                return self._switch(kind, name, path, scope)
            case Group(child=child):
                return GroupNode(name, path, runtime, [self._child(child, 0, path, scope)])
            case Loop(until=until, body=body):
                answer = self._until(until, path, scope)
                built = self._child(body, 0, path, scope)
                return LoopNode(kind, name, path, runtime, built, answer, self._rounds)
            case ForEach(body=body):
                built = self._child(body, 0, path, scope)
                return ForEachNode(kind, name, path, runtime, built, scope, self._rounds)
            case Consume(body=body):
                built = self._child(body, 0, path, scope)
                return ConsumeNode(kind, name, path, runtime, built, scope, self._rounds)
            case RunLeaf(use=use):
                return RunNode(use, name, path, runtime, scope)
            case CheckLeaf(use=use):
                return CheckNode(name, path, runtime, Asked(use, path, runtime, scope))
            case CheckKeys(condition=condition):
                answer = build_condition(condition, path, runtime, scope)
                return CheckNode(name, path, runtime, answer)
            case Wait(duration_s=duration_s):
                return WaitNode(name, path, runtime, duration_s)
            case Set(values=values):
                return SetNode(name, path, runtime, values, scope)
            case Ask():
                return AskNode(kind, name, path, runtime, scope)
            case Call():
                return self._call(kind, name, path, scope)

    def _until(self, until: Condition | None, path: str, scope: Scope) -> Answer | None:
        return build_condition(until, f"{path}@until", self._runtime, scope) if until else None

    def _composite(self, kind: Composite, name: str, path: str, scope: Scope) -> Behaviour:
        runtime, children = self._runtime, self._children(kind.children, path, scope)
        if kind.kind.startswith("reactive"):
            for child in children[:-1]:
                _mark_repeated(child)
        match kind.kind:
            case "persistent_sequence":
                return PersistentSequenceNode(name, path, runtime, children, scope)
            case "reactive_sequence":
                asking = [asks(child, self._mission.trees) for child in kind.children]
                return ReactiveSequenceNode(name, path, runtime, children, asking)
            case "reactive_fallback":
                return ReactiveFallbackNode(name, path, runtime, children)
            case "fallback":
                return FallbackNode(name, path, runtime, children)
        return SequenceNode(name, path, runtime, children)

    def _branch(self, kind: Branch, name: str, path: str, scope: Scope) -> Behaviour:
        answer = build_condition(kind.condition, f"{path}@{kind.kind}", self._runtime, scope)
        then, *otherwise = self._children(
            (one for one in (kind.then, kind.otherwise) if one), path, scope
        )
        node = IfElseNode if kind.kind == "if" else WhileElseNode
        return node(name, path, self._runtime, answer, then, otherwise[0] if otherwise else None)

    def _switch(self, kind: Switch, name: str, path: str, scope: Scope) -> Behaviour:
        cases = dict(zip(kind.cases, self._children(kind.cases.values(), path, scope), strict=True))
        otherwise = self._child(kind.otherwise, len(cases), path, scope) if kind.otherwise else None
        return SwitchNode(name, path, self._runtime, kind.source, cases, otherwise, scope)

    def _call(self, kind: Call, name: str, path: str, scope: Scope) -> Behaviour:
        tree = self._mission.trees[kind.tree]
        inner = Scope(Store(), {**scope.uses, **kind.uses})
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
        status: SUCCESS, FAILURE, RUNNING, SKIPPED for left out, or INVALID for not ticked.
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
    return tuple(_states(root, 0, "", is_shown=True, is_left_out=False))


def _states(
    node: Behaviour, depth: int, said: str, *, is_shown: bool, is_left_out: bool
) -> Iterator[NodeState]:
    feedback = node.feedback_message or (said if node.status is Status.RUNNING else "")
    is_left_out = (is_left_out and node.status is Status.INVALID) or (
        node.is_skipped and node.status is Status.SUCCESS
    )
    if node.is_journalled:
        words = (
            f"{said}: {feedback}"
            if said and said not in feedback and feedback not in said
            else feedback or said
        )
        status = "SKIPPED" if is_left_out else node.status.name
        yield NodeState(node.path, node.name, depth, status, words, is_shown)
        is_shown, depth, said, is_left_out = node.status is Status.RUNNING, depth + 1, "", False
    elif isinstance(node, RetryNode) or (is_left_out and feedback):
        said = feedback
    for child in node.children:
        yield from _states(child, depth, said, is_shown=is_shown, is_left_out=is_left_out)
