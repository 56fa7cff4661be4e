"""What mocked leaves do: outcomes by place, in the order in which they are given."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from executive.dry_run.made_up import Recipe


class MockedStatus(StrEnum):
    """How a mocked leaf ends."""

    SUCCESS = "success"
    FAILURE = "failure"
    RUNNING = "running"  # it does not end by itself


@dataclass(frozen=True, slots=True)
class MockedOutcome:
    """One outcome of a leaf.

    Attributes:
        status: How it ends.
        after_s: Of an action, its duration [s]. Of a condition, the time for which the answer
            before this one holds; None for one more asking.
        reason: Why it failed.
        is_final: No repetition can change the failure, as `failed(is_final=True)` of a leaf.
        outputs: Values of its outputs by port; those that are missing of a success are made up.
        answer: The choice that answers a question with choices.
    """

    status: MockedStatus = MockedStatus.SUCCESS
    after_s: float | None = None
    reason: str = ""
    is_final: bool = False
    outputs: Mapping[str, Recipe] = field(default_factory=dict)
    answer: str = ""


class Outcomes:
    """The outcomes of one entry of a file, taken in order; the last one is given again and again.

    Leaves that the same entry names share them.
    """

    def __init__(self, outcomes: tuple[MockedOutcome, ...]) -> None:
        self._outcomes = outcomes
        self._next = 0
        self._since_s: float | None = None  # when the present answer of a condition began to hold

    def take(self) -> MockedOutcome:
        """Return the next outcome of an action or of a question."""
        found = self._outcomes[min(self._next, len(self._outcomes) - 1)]
        self._next += 1
        return found

    def answer(self, now_s: float, epsilon_s: float) -> tuple[MockedOutcome, float | None]:
        """Return what a condition answers now, and when the next answer is due [s], if one is."""
        if self._since_s is None:
            self._since_s = now_s
        else:
            self._since_s = self._go_on(self._since_s, now_s, epsilon_s)
        later = self._outcomes[self._next + 1] if self._next + 1 < len(self._outcomes) else None
        if later is None:
            return self._outcomes[self._next], None
        due_s = now_s if later.after_s is None else self._since_s + later.after_s
        return self._outcomes[self._next], due_s

    def _go_on(self, since_s: float, now_s: float, epsilon_s: float) -> float:
        """Pass over the answers whose time is over; return when the present one began [s]."""
        while self._next + 1 < len(self._outcomes):
            after_s = self._outcomes[self._next + 1].after_s
            if after_s is None:
                self._next += 1
                return now_s
            if now_s < since_s + after_s - epsilon_s:
                return since_s
            since_s += after_s
            self._next += 1
        return since_s


@dataclass(frozen=True, slots=True)
class Script:
    """What a file says of the leaves.

    Attributes:
        outcomes: Outcomes by the path of a leaf or of a question, with the entry that they are of.
    """

    outcomes: Mapping[str, tuple[str, tuple[MockedOutcome, ...]]] = field(default_factory=dict)

    def begin(self) -> dict[str, Outcomes]:
        """Return the outcomes for one run, by path."""
        entries = {entry: Outcomes(outcomes) for entry, outcomes in self.outcomes.values()}
        return {path: entries[entry] for path, (entry, _) in self.outcomes.items()}
