"""A checked mission: its settings, its plugins, its trees; frozen, and free of YAML."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from pydantic import Field

from executive.config import Seconds, Settings
from executive.faults.description import Fault
from executive.leaf.action import Leaf
from executive.messages.region import Region
from executive.tree.expressions.syntax import Expression
from executive.tree.job_settings import JobSettings
from executive.tree.place import Place
from executive.tree.problem import Mark, Problem
from executive.watch.rules import Watched


class LoopSettings(Settings):
    """Settings of the tick loop."""

    tick: Seconds = Field(0.05, ge=0.001, le=1.0, description="Period of the loop [s].")
    time_limit: Seconds = Field(
        7200.0, gt=0, description="The mission fails when it has taken this long [s]."
    )
    runner: Literal["inline", "thread", "process"] | None = Field(
        None,
        description="Where long verbs are computed; not given, inline in lock-step, and in worker "
        "processes on the wall clock, where inline is refused.",
    )
    late_ticks: int | None = Field(
        None,
        ge=1,
        description="On the wall clock, so many late ticks in a row bring the machine to a safe "
        "stop; not given, as many as fit into the machine's longest stop.",
    )
    heartbeat_limit: Seconds = Field(
        0.2,
        gt=0,
        description="In real time, a supervisor stops the machine when the loop is silent for so "
        "long, or the newest joint sample is so old [s].",
    )
    jobs: JobSettings = Field(JobSettings(), description="Limits of the long verbs.")


# What an error of a plugin means: `stop` ends the mission in a safe stop, `fail` lets the node fail
# that waited for it, and a stream plugin is used no more.
ON_ERROR = "on_error"
ON_ERROR_WORDS = ("stop", "fail")


@dataclass(frozen=True, slots=True)
class Selection:
    """A plugin that a mission has chosen.

    Attributes:
        name: Its name, as installed.
        settings: Checked settings.
        can_fail: Whether the mission goes on when the plugin raises an error (`on_error: fail`).
        uses: Name of the plugin that it is given, by capability, where there are several.
    """

    name: str
    settings: Settings
    can_fail: bool = False
    uses: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Ref:
    """A reference to a key of the store, `"{key}"`; not listed, a port uses its own name."""

    key: str
    mark: Mark
    is_listed: bool = True


@dataclass(frozen=True, slots=True)
class Computed:
    """An expression on keys of the store: `{stone.mass} > 0.8 t`."""

    expression: Expression
    place: Place = field(compare=False)

    @property
    def mark(self) -> Mark:
        return self.place.mark

    def __str__(self) -> str:
        return str(self.expression)


@dataclass(frozen=True, slots=True)
class Template:
    """A text with expressions in it: `Lift stone {stone.id}?`; each part is one or the other."""

    parts: tuple[str | Expression, ...]
    place: Place = field(compare=False)

    @property
    def mark(self) -> Mark:
        return self.place.mark

    def __str__(self) -> str:
        return self.place.value


@dataclass(frozen=True, slots=True)
class Literally:
    """A value written in the mission file itself."""

    value: Any


KeySource = Ref | Computed | Template  # what reads keys
Source = KeySource | Literally


@dataclass(frozen=True, slots=True)
class Parameters:
    """Settings of a leaf that are computed when it starts.

    Attributes:
        literals: The settings that the file writes out, by name.
        sources: Where the others come from, by name.
    """

    literals: Mapping[str, Any]
    sources: Mapping[str, KeySource]


@dataclass(frozen=True, slots=True)
class LeafUse:
    """A leaf with its settings and its wiring; every port that is connected is listed.

    Attributes:
        name: Name of the behaviour, as installed.
        leaf: Its class.
        settings: Checked settings; of those that are computed at the start, the defaults.
        inputs: Where the value of each input port comes from.
        outputs: Key of the store by output port.
        mark: Where it stands.
        parameters: The settings, if some of them are computed.
        uses: Name of the plugin that it uses, by capability, where there are several.
    """

    name: str
    leaf: type[Leaf[Any]]
    settings: Settings
    inputs: Mapping[str, Source]
    outputs: Mapping[str, Ref]
    mark: Mark
    parameters: Parameters | None = None
    uses: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class KeyHolds:
    """A condition: a key of the store holds true."""

    key: str
    mark: Mark


@dataclass(frozen=True, slots=True)
class Combined:
    """A condition made of others: `not` (of one), `all` or `any`."""

    how: Literal["not", "all", "any"]
    parts: tuple["Condition", ...]


Condition = LeafUse | KeyHolds | Computed | Combined


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
        match self.kind:
            case Composite(children=children) | Parallel(children=children):
                return children
            case Group(child=child) | Turned(child=child):
                return (child,)
            case Loop(body=body) | ForEach(body=body) | Consume(body=body):
                return (body,)
            case Branch(then=then, otherwise=otherwise):
                return (then,) if otherwise is None else (then, otherwise)
            case Switch(cases=cases, otherwise=otherwise):
                return (*cases.values(), *(() if otherwise is None else (otherwise,)))
        return ()

    def walk(self) -> Iterator["Node"]:
        """Yield this node and all below, those of `on_failure` and `on_halt` included."""
        yield self
        beside = (self.modifiers.on_failure, self.modifiers.on_halt)
        for child in (*self.children(), *(one for one in beside if one)):
            yield from child.walk()


@dataclass(frozen=True, slots=True)
class TypeName:
    """The declared type of a tree's port: `Stone`, `list[Stone]`, or `Stone?` if optional."""

    text: str
    mark: Mark

    @property
    def is_optional(self) -> bool:
        return self.text.endswith("?")

    @property
    def name(self) -> str:
        return self.text.removesuffix("?")


@dataclass(frozen=True, slots=True)
class Tree:
    """A named tree; its ports say which values go in and out."""

    name: str
    root: Node
    inputs: Mapping[str, TypeName]
    outputs: Mapping[str, TypeName]
    mark: Mark


@dataclass(frozen=True, slots=True)
class MissionFile:
    """A mission without mistakes.

    Attributes:
        name: What `mission:` says.
        description: One line for people.
        loop: Settings of the tick loop.
        plugins: Selections by capability, in the order in which data flows; only `monitoring` may
            have several. A plugin with a name stands under `capability.name`.
        trees: `main`, and every tree that it calls.
        warnings: What works but was hardly meant.
        regions: Named parts of the ground, by name.
        faults: What is done to the mission on purpose, in the order of the file.
        watch: What is watched while it runs, and what happens then, by condition.
    """

    name: str
    description: str
    loop: LoopSettings
    plugins: Mapping[str, tuple[Selection, ...]]
    trees: Mapping[str, Tree]
    warnings: tuple[Problem, ...] = field(default=())
    regions: Mapping[str, Region] = field(default_factory=dict)
    faults: tuple[Fault, ...] = field(default=())
    watch: Watched = field(default_factory=dict)
