"""Events of the tree's nodes: when they began and ended, and what modifiers decided."""

from dataclasses import dataclass
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
        source: `operator`, `option` or `default`.
    """

    question: str
    answer: bool | str
    source: str
