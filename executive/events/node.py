"""Events of the tree's nodes: when they began and ended, and what modifiers decided."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from executive.events.event import Event


class NodeResult(StrEnum):
    """How a node ended."""

    SUCCESS = "success"
    FAILURE = "failure"
    HALTED = "halted"
    SKIPPED = "skipped"


@dataclass(frozen=True, slots=True, eq=False)
class NodeStarted(Event):
    """A node began a round of activity."""


@dataclass(frozen=True, slots=True, eq=False)
class NodeEnded(Event):
    """A node ended, was cancelled by its parent (`halted`), or left all its children out
    (`skipped`).
    """

    status: NodeResult
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class LeafCalled(Event):
    """An action begins.

    Attributes:
        inputs: Its inputs by port; of a large value, its class alone.
    """

    inputs: Mapping[str, object]


@dataclass(frozen=True, slots=True, eq=False)
class LeafAnswered(Event):
    """A leaf answered; of a condition, only an answer that differs from the one before.

    Attributes:
        success: Whether it succeeded.
        reason: Why it failed, or a remark.
        is_final: It failed for a cause that repetition cannot change.
        outputs: Its outputs by port, as `executive.journal.value_folder` keeps values.
        state: What the leaf itself remembers, kept in the same way.
        draws: How often the leaf has asked for a random generator.
        visit: Number of this visit of a condition in its tick, from 1; 0 for an action.
    """

    success: bool
    reason: str
    is_final: bool = False
    outputs: Mapping[str, object] = field(default_factory=dict)
    state: object = None
    draws: int = 0
    visit: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class LeafTakenUp(Event):
    """A leaf that was under way when its run was cut off is taken up again.

    Attributes:
        policy: What its class declares: redo, verify, ask or fail.
    """

    policy: str


@dataclass(frozen=True, slots=True, eq=False)
class NodeLeftOut(Event):
    """The condition at `if` did not hold, and the node was skipped."""

    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class NodeForbidden(Event):
    """The condition at `while` no longer held, and the node was cancelled."""

    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class NodeTimedOut(Event):
    """A node was cancelled because it took longer than its `timeout` [s]."""

    limit_s: float


@dataclass(frozen=True, slots=True, eq=False)
class NodeRetried(Event):
    """A node failed and is to be attempted again.

    Attributes:
        attempt: Number of the attempt that failed, from 1.
        of: Number of attempts in all.
        reason: Why it failed.
    """

    attempt: int
    of: int
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class NodeNotRetried(Event):
    """A node failed for a cause that repetition cannot change, and `retry` gave up at once."""

    attempt: int
    of: int
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class NodeExcused(Event):
    """An `optional` node failed, which counts as success."""

    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class QuestionAnswered(Event):
    """The operator, an option or the default answered a question.

    Attributes:
        question: Text of the question.
        answer: True for yes, or the choice.
        source: `operator`, `option` or `default`; in a dry run also `mock` or `seed`.
    """

    question: str
    answer: bool | str
    source: str
