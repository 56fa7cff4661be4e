"""The nodes of a checked mission: each kind, its modifiers, its children; frozen."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from executive.tree.key_source import Computed, Ref, Source, Template
from executive.tree.leaf_use import Condition, KeyHolds, LeafUse
from executive.tree.problem import Mark


@dataclass(frozen=True, slots=True)
class Attempts:
    """How often a node is tried in all, and the pause between two attempts [s]."""

    count: int
    pause_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Modifiers:
    """The modifiers of a node, outermost first."""

    if_: Condition | None = None
    once: bool = False
    while_: Condition | None = None
    timeout_s: float | None = None
    retry: Attempts | None = None
    on_failure: "Node | None" = None
    optional: bool = False
    on_halt: "Node | None" = None
    name: str = ""
    title: Template | None = None  # a name with keys in it, filled in when the node begins


UNREADABLE = "unreadable"


@dataclass(frozen=True, slots=True)
class Composite:
    """A sequence or fallback, the same reactive, or a `persistent_sequence`.

    While a mission is read, one of kind `UNREADABLE` stands for a node that was refused, so that
    the nodes around it are checked all the same; a mission without mistakes has none.
    """

    kind: str
    children: tuple["Node", ...]

    @property
    def label(self) -> str:
        return self.kind


@dataclass(frozen=True, slots=True)
class Parallel:
    """`parallel`: all children at once.

    Attributes:
        children: What is ticked.
        succeed: How many must succeed; all of them means all that were not left out.
        fail: How many failures make it fail.
        wait_for_all: Whether all children are ticked to their end before the result counts.
    """

    children: tuple["Node", ...]
    succeed: int
    fail: int
    wait_for_all: bool = False
    label: str = "parallel"

    @property
    def needs_all(self) -> bool:
        return self.succeed == len(self.children)


@dataclass(frozen=True, slots=True)
class Turned:
    """`not` or `force_failure`: one node whose end counts otherwise."""

    kind: str
    child: "Node"

    @property
    def label(self) -> str:
        return self.kind


@dataclass(frozen=True, slots=True)
class Branch:
    """`if`/`then`/`else`, asked once, or `while`/`do`/`else`, asked at each tick."""

    kind: Literal["if", "while"]
    condition: Condition
    then: "Node"
    otherwise: "Node | None"

    @property
    def label(self) -> str:
        return self.kind


@dataclass(frozen=True, slots=True)
class Switch:
    """`switch`: the case that the value of a key names."""

    source: Ref
    cases: Mapping[str, "Node"]
    otherwise: "Node | None"
    label: str = "switch"


@dataclass(frozen=True, slots=True)
class Group:
    """`do`: one node, given modifiers of its own."""

    child: "Node"
    label: str = "do"


@dataclass(frozen=True, slots=True)
class Loop:
    """`loop`: until a condition holds, or so many rounds; with neither it has no end."""

    until: Condition | None
    max_rounds: int | None
    body: "Node"
    label: str = "loop"


@dataclass(frozen=True, slots=True)
class ForEach:
    """`for_each`: once for each item of a list, in order."""

    item: str
    source: Source
    body: "Node"
    label: str = "for_each"


@dataclass(frozen=True, slots=True)
class Consume:
    """`consume`: takes one item after the other off a list key, until the list is empty."""

    item: str
    source: Ref
    body: "Node"
    label: str = "consume"


@dataclass(frozen=True, slots=True)
class RunLeaf:
    """`run`: an action."""

    use: LeafUse

    @property
    def label(self) -> str:
        return self.use.name


@dataclass(frozen=True, slots=True)
class CheckLeaf:
    """`check`: a condition as a node."""

    use: LeafUse

    @property
    def label(self) -> str:
        return self.use.name


@dataclass(frozen=True, slots=True)
class CheckKeys:
    """`check` with an expression on keys."""

    condition: KeyHolds | Computed
    label: str = "check"


@dataclass(frozen=True, slots=True)
class Wait:
    """`wait`: let the mission's time pass."""

    duration_s: float
    label: str = "wait"


@dataclass(frozen=True, slots=True)
class Set:
    """`set`: write literals, or copies of other keys, into the store."""

    values: Mapping[str, Source]
    label: str = "set"


@dataclass(frozen=True, slots=True)
class Ask:
    """`ask`: put a question to the operator; yes is success, and so is any of the choices.

    Attributes:
        question: The text.
        default: What an empty line means, and what is taken when nobody can answer.
        choices: What to choose from; empty for yes and no.
        answer: The key that takes the choice.
    """

    question: Template
    default: bool | str | None
    choices: tuple[str, ...] = ()
    answer: Ref | None = None
    label: str = "ask"


@dataclass(frozen=True, slots=True)
class Call:
    """`call`: another tree, with a store of its own; ports carry values in and out."""

    tree: str
    inputs: Mapping[str, Source]
    outputs: Mapping[str, Ref]
    mark: Mark
    uses: Mapping[str, str] = field(default_factory=dict)

    @property
    def label(self) -> str:
        return self.tree


Kind = (
    Composite
    | Parallel
    | Turned
    | Branch
    | Switch
    | Group
    | Loop
    | ForEach
    | Consume
    | RunLeaf
    | CheckLeaf
    | CheckKeys
    | Wait
    | Set
    | Ask
    | Call
)


@dataclass(frozen=True, slots=True)
class Node:
    """One node of a tree: its kind, its modifiers and its place in the file."""

    kind: Kind
    modifiers: Modifiers
    mark: Mark

    @property
    def label(self) -> str:
        """Return the name that people and paths call it by."""
        label = (
            "retry" if isinstance(self.kind, Group) and self.modifiers.retry else self.kind.label
        )
        return self.modifiers.name or label

    def children(self) -> tuple["Node", ...]:
        """Return the nodes directly below, without those of `on_failure` and `on_halt`."""
        below = _CHILDREN.get(type(self.kind))
        return () if below is None else below(self.kind)

    def walk(self) -> Iterator["Node"]:
        """Yield this node and all below, those of `on_failure` and `on_halt` included."""
        waiting = [self]
        while waiting:
            node = waiting.pop()
            yield node
            waiting.extend(reversed(node.below()))

    def below(self) -> tuple["Node", ...]:
        """Return the nodes directly below, those of `on_failure` and `on_halt` included."""
        beside = (self.modifiers.on_failure, self.modifiers.on_halt)
        if beside == (None, None):
            return self.children()
        return (*self.children(), *(one for one in beside if one))


def _branches(branch: Branch) -> tuple[Node, ...]:
    return (branch.then,) if branch.otherwise is None else (branch.then, branch.otherwise)


def _cases(switch: Switch) -> tuple[Node, ...]:
    otherwise = () if switch.otherwise is None else (switch.otherwise,)
    return (*switch.cases.values(), *otherwise)


# Kinds that have nodes below, and how these are found.
_CHILDREN: Mapping[type, Callable[[Any], tuple[Node, ...]]] = {
    Composite: lambda kind: kind.children,
    Parallel: lambda kind: kind.children,
    Group: lambda kind: (kind.child,),
    Turned: lambda kind: (kind.child,),
    Loop: lambda kind: (kind.body,),
    ForEach: lambda kind: (kind.body,),
    Consume: lambda kind: (kind.body,),
    Branch: _branches,
    Switch: _cases,
}
