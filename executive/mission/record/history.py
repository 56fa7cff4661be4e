"""The past of a resumed mission: what its tree recorded, given back in the same order.

The tree is ticked again through its past. Each leaf answers what it answered then; everything else
follows from that, and is compared with the journal line by line.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from executive.errors import DataError
from executive.events import node as node_events
from executive.events.event import Event
from executive.events.mission import WorldObserved
from executive.events.node import LeafAnswered, LeafCalled, LeafTakenUp, QuestionAnswered
from executive.journal import Entry
from executive.journal.value_folder import ValueFolder
from executive.leaf.memory import Recalled
from executive.leaf.outcome import Outcome

_BEGINNINGS = (LeafCalled, LeafTakenUp, QuestionAnswered)


class History:
    """The entries of a tree, and how far they have been followed.

    Attributes:
        tick: Number of the tick that is followed.
        time_s: The mission's time in it [s].
        answers: The newest answer of each leaf so far.
    """

    def __init__(self, entries: Iterable[Entry], values: ValueFolder) -> None:
        self._entries = tree_entries(entries)
        self._values = values
        self._at = 0
        self.tick, self.time_s = 0, 0.0
        self.answers: dict[str, LeafAnswered] = {}

    @property
    def is_over(self) -> bool:
        """Whether everything was followed: the present begins."""
        return self._at >= len(self._entries)

    @property
    def last_tick(self) -> int:
        """Return the number of the last tick, in which the run was cut off."""
        return self._entries[-1].tick if self._entries else 0

    def follow(self, tick_tree: Callable[[], None], *, every_tick: bool) -> None:
        """Tick the tree through all ticks before the last one.

        Args:
            tick_tree: Ticks it once.
            every_tick: Also through ticks in which nothing was recorded: a loop that is asked anew
                at each tick counts its rounds there. Otherwise nothing happens in them.

        Raises:
            DataError: If the tree does something else than it did.
        """
        while not self.is_over and self._next.tick < self.last_tick:
            entry, before = self._next, self._at
            if every_tick:
                self._follow_silent(entry, tick_tree)
            self.tick, self.time_s = entry.tick, entry.time_s
            tick_tree()
            if self._at == before:
                raise self._differs("the tree does nothing")
        if not self.is_over:
            self.tick = self.last_tick

    def visit(self, node: str, *, is_condition: bool, number: int) -> Recalled | None:
        """Return how a visit of a leaf went; None if it is beyond the past."""
        has_begun = False
        while not self.is_over and self._next.node == node and self._is_beginning():
            has_begun, self._at = True, self._at + 1
        if self.is_over:
            return Recalled(None, {}, True) if has_begun else None
        found = self._next.event
        if self._next.node == node and isinstance(found, LeafAnswered):
            is_now = self._next.tick == self.tick
            if is_now and (not is_condition or found.visit == number):
                self._at += 1
                self.answers[node] = found
                return self._recalled(found, has_begun)
        if not is_condition:
            return Recalled(None, {}, has_begun)
        if node not in self.answers:
            raise self._differs(f"{node} is asked")
        return self._recalled(self.answers[node], has_begun)

    def compare(self, node: str, event: Event) -> None:
        """Take what the tree records, which must be what it recorded then.

        Raises:
            DataError: If it is something else.
        """
        told = f"{node or 'the mission'} records {event.kind} {dict(event.payload())}"
        if self.is_over:
            raise self._differs(told)
        entry = self._next
        if (entry.node, entry.kind) != (
            node,
            event.kind,
        ) or entry.event.payload() != event.payload():
            raise self._differs(told)
        self._at += 1

    def answer_to(self, node: str) -> QuestionAnswered | None:
        """Return how a question was answered, if it was in this tick."""
        if self.is_over or self._next.node != node or self._next.tick != self.tick:
            return None
        event = self._next.event
        return event if isinstance(event, QuestionAnswered) else None

    @property
    def _next(self) -> Entry:
        return self._entries[self._at]

    def _is_beginning(self) -> bool:
        return isinstance(self._next.event, _BEGINNINGS) and self._next.tick == self.tick

    def _follow_silent(self, until: Entry, tick_tree: Callable[[], None]) -> None:
        first, first_s = self.tick, self.time_s
        for tick in range(first + 1, until.tick):
            share = (tick - first) / (until.tick - first)
            self.tick, self.time_s = tick, first_s + share * (until.time_s - first_s)
            tick_tree()

    def _recalled(self, found: LeafAnswered, has_begun: bool) -> Recalled:
        outcome: Outcome[Any] = Outcome(found.success, found.reason, None, found.is_final)
        written = {port: self._values.get(value) for port, value in found.outputs.items()}
        return Recalled(outcome, written, has_begun)

    def _differs(self, told: str) -> DataError:
        where = "after its end"
        if not self.is_over:
            entry = self._next
            where = f"at line {entry.sequence + 1}: {entry.node} {entry.kind} at {entry.time_s} s"
        return DataError(
            f"the journal cannot be followed {where}; now {told}. The mission's file, a leaf or a "
            "node has changed since"
        )


def tree_entries(entries: Iterable[Entry]) -> list[Entry]:
    """Return what the tree recorded.

    The tick in which a run was cut off is gone through again when it is resumed, once the world was
    observed: its entries count to the tick in which it was.
    """
    found: list[Entry] = []
    for entry in entries:
        if isinstance(entry.event, WorldObserved):
            cut_off = found[-1].tick if found else 0
            for number in range(len(found) - 1, -1, -1):
                if found[number].tick != cut_off:
                    break
                found[number] = replace(found[number], tick=entry.tick, time_s=entry.time_s)
        elif is_of_tree(entry.node, entry.event):
            found.append(entry)
    return found


def is_of_tree(node: str, event: Event) -> bool:
    """Return whether the tree itself recorded an event, and not a leaf, a plugin or the mission."""
    return node.startswith("main") and type(event).__module__ == node_events.__name__
