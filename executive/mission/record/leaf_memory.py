"""The memory of a mission's leaves: written into the journal, and read back from it."""

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from executive.events.event import Event, plain
from executive.events.node import LeafAnswered, LeafCalled, LeafTakenUp
from executive.journal.value_folder import ValueFolder
from executive.leaf.memory import Memory, OnResume, Recalled
from executive.leaf.outcome import Outcome
from executive.leaf.runtime import Question
from executive.mission.record.history import History, is_of_tree

_SHORT = 8  # items of a list that are written out among the inputs


class Draws(Protocol):
    """What counts how often a leaf has asked for a random generator."""

    draws: int


class PastQuestion(Question):
    """A question of the past: answered as it was, or put again if it was still open."""

    def __init__(self, history: History, node: str, ask: Callable[[], Question]) -> None:
        self._history = history
        self._node = node
        self._ask = ask
        self._now: Question | None = None
        self._source = ""

    def answer(self) -> bool | str | None:
        if self._now is None and self._history.is_over:
            self._now = self._ask()
        if self._now is not None:
            return self._now.answer()
        answered = self._history.answer_to(self._node)
        self._source = answered.source if answered else ""
        return answered.answer if answered else None

    def source(self) -> str:
        return self._now.source() if self._now is not None else self._source


class LeafMemory(Memory):
    """Keeps answers as events of the nodes, and follows the past of a resumed mission.

    Attributes:
        history: The past; None in a mission that was not cut off.
        has_answered: A leaf has answered since this was set to False.
    """

    def __init__(self, values: ValueFolder, secure: Callable[[], None]) -> None:
        self._values = values
        self._secure = secure
        self._record: Callable[[str, Event], None] = lambda node, event: None
        self._restore: dict[str, Callable[[Mapping[str, Any]], None]] = {}
        self._draws: dict[str, Draws] = {}
        self._visits: Counter[str] = Counter()
        self._tick = -1
        self._is_live = self._is_left = False
        self._told: dict[str, Mapping[str, Any]] = {}  # the newest answer of each condition
        self.history: History | None = None
        self.has_answered = False

    def bind(self, record: Callable[[str, Event], None]) -> None:
        """Name where events go."""
        self._record = record

    def watch(self, node: str, draws: Draws) -> None:
        """Name what counts a leaf's random generators."""
        self._draws[node] = draws

    @property
    def failure(self) -> OSError | None:
        """Return why answers are no longer kept; None while they are."""
        return self._values.failure

    @property
    def is_past(self) -> bool:
        """Whether the past is being followed."""
        return self.history is not None and not self.history.is_over

    def leave_past(self) -> None:
        """Follow the past no further: a mission that ends before its past has been followed cancels
        nodes that had gone on then, and nothing of that is recorded.
        """
        self._is_left = True

    def begin_tick(self, tick: int) -> None:
        """Begin a tick of the tree."""
        if tick != self._tick:
            self._tick = tick
            self._visits.clear()

    def _go_live(self, history: History) -> None:
        """Give all leaves their own state back, before the first of them is asked itself.

        Raises:
            DataError: If the state of one was not kept.
        """
        for node, answer in history.answers.items():
            self._told[node] = _told(answer)
            if node in self._draws:
                self._draws[node].draws = answer.draws
            if answer.state is not None and node in self._restore:
                self._restore[node](self._values.get(answer.state))

    def recall(self, node: str, *, is_condition: bool) -> Recalled | None:
        if is_condition:
            self._visits[node] += 1
        if self.history is None:
            return None
        if not self.history.is_over:
            found = self.history.visit(node, is_condition=is_condition, number=self._visits[node])
            if found is not None:
                return found
        if not self._is_live:
            self._is_live = True
            self._go_live(self.history)
        return None

    def took(self, node: str, event: Event) -> bool:
        """Take what the tree records while its past is followed; return whether it is.

        Raises:
            DataError: If it records something else than it did.
        """
        if not self.is_past or self.history is None or not is_of_tree(node, event):
            return False
        if self._is_left:
            return True
        self.history.compare(node, event)
        return True

    def question(self, node: str, ask: Callable[[], Question]) -> Question:
        """Return a question: in the past, as it was answered then."""
        if not self.is_past or self.history is None:
            return ask()
        return PastQuestion(self.history, node, ask)

    def called(self, node: str, inputs: Mapping[str, Any], *, is_irreversible: bool) -> None:
        self._record(node, LeafCalled({port: shown(value) for port, value in inputs.items()}))
        if is_irreversible:
            self._secure()

    def taken_up(self, node: str, policy: OnResume) -> None:
        self._record(node, LeafTakenUp(policy))

    def answered(
        self,
        node: str,
        outcome: Outcome[Any],
        written: Mapping[str, Any],
        state: Mapping[str, Any],
        *,
        is_condition: bool,
    ) -> None:
        answer = LeafAnswered(
            success=outcome.success,
            reason=outcome.reason,
            is_final=outcome.is_final,
            outputs={port: self._values.put(value) for port, value in written.items()},
            state=self._values.put(state) if state else None,
            draws=self._draws[node].draws if node in self._draws else 0,
            visit=self._visits[node],  # 0 of an action
        )
        self.has_answered, told = True, _told(answer)
        if is_condition and self._told.get(node) == told:
            return
        self._told[node] = told
        self._record(node, answer)

    def attach(self, node: str, restore: Callable[[Mapping[str, Any]], None]) -> None:
        self._restore[node] = restore


def _told(answer: LeafAnswered) -> Mapping[str, Any]:
    return {**answer.payload(), "visit": 0}


def shown(value: Any) -> Any:
    """Return a value as it is shown to a person: a large one by its class."""
    if value is None or isinstance(value, bool | int | float | str):
        return plain(value)
    if isinstance(value, list | tuple):
        items = [shown(one) for one in value[:_SHORT]]
        return items if len(value) <= _SHORT else [*items, f"… {len(value)} in all"]
    of_note = {n: plain(getattr(value, n)) for n in ("id", "stone_id") if hasattr(value, n)}
    return {"class": type(value).__name__, **of_note}
