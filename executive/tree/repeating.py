"""Nodes that repeat their body: loop, for_each and consume.

A round that begins and ends within one tick costs no tick: the next round begins at once. A round
that took time ends its tick, so that the next one begins with the observations of a new tick.

py_trees' ForEach ticks its child once on an empty list; here no items are a success that ticks
nothing.
"""

from abc import abstractmethod
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.errors import ConfigError
from executive.leaf.runtime import Runtime
from executive.tree.conditions import Answer
from executive.tree.node_kinds import Consume, ForEach, Loop
from executive.tree.nodes import Controller, Steps, stop_child
from executive.tree.rounds import Rounds
from executive.tree.wiring import Scope


class RepeatingNode(Controller):
    """Ticks its body again and again; the first failing round is its failure.

    A round that leaves its body out is a round.
    """

    _done: int  # rounds since it began

    def __init__(
        self, name: str, path: str, runtime: Runtime, body: Behaviour, rounds: Rounds
    ) -> None:
        super().__init__(name, path, runtime, [body])
        self._body = body
        self._rounds = rounds

    def begin(self) -> None:
        self._done = 0

    def proceed(self) -> Steps:
        with self._rounds.tick():
            while self._body.status is Status.RUNNING or self._rounds.take():
                was_running = self._body.status is Status.RUNNING
                if not was_running:
                    end = self._next_round()
                    if end is not None:
                        return end
                    stop_child(self._body, everything=True)
                yield from self._body.tick()
                if self._body.status is Status.FAILURE:
                    return self.adopt(self._body)
                if self._body.status is Status.SUCCESS:
                    self._done += 1
                self.feedback_message = self._progress()
                if was_running or self._body.status is Status.RUNNING:
                    break
        if self._body.status is not Status.RUNNING:  # the next round begins at the next tick
            self.runtime.due(self.runtime.clock.now_s())
        return Status.RUNNING

    @abstractmethod
    def _next_round(self) -> Status | None:
        """Prepare the next round, or return the node's status if there is none."""

    @abstractmethod
    def _progress(self) -> str:
        """Return how far the node is."""


class LoopNode(RepeatingNode):
    """Checks `until` before each round and after the last; a failing round is its failure.

    Without `until`, all rounds done is success; with it, `max` rounds without a yes are a failure.
    With neither it goes on until its body fails or it is halted.
    """

    def __init__(
        self,
        kind: Loop,
        name: str,
        path: str,
        runtime: Runtime,
        body: Behaviour,
        until: Answer | None,
        rounds: Rounds,
    ) -> None:
        super().__init__(name, path, runtime, body, rounds)
        self._until = until
        self._max = kind.max_rounds

    @property
    def has_until(self) -> bool:
        """Return whether a condition ends the loop."""
        return self._until is not None

    @property
    def has_limit(self) -> bool:
        """Return whether the number of rounds is limited."""
        return self._max is not None

    def _progress(self) -> str:
        return f"round {min(self._done + 1, self._max or self._done + 1)}" + (
            f" of at most {self._max}" if self._max else ""
        )

    def _next_round(self) -> Status | None:
        if self._until is not None:
            answer = self._until()
            if answer.success:
                self.feedback_message = answer.reason
                return Status.SUCCESS
        if self._max is None or self._done < self._max:
            return None
        if self._until is None:
            self.feedback_message = f"{self._done} rounds"
            return Status.SUCCESS
        self.feedback_message = f"not there after {self._max} rounds: {answer.reason}"
        return Status.FAILURE


class ForEachNode(RepeatingNode):
    """Ticks its body once for each item of a list; the first failing body is its failure."""

    def __init__(
        self,
        kind: ForEach,
        name: str,
        path: str,
        runtime: Runtime,
        body: Behaviour,
        scope: Scope,
        rounds: Rounds,
    ) -> None:
        super().__init__(name, path, runtime, body, rounds)
        self._kind = kind
        self._scope = scope
        self._items: list[Any] | None = None

    def begin(self) -> None:
        super().begin()
        self._items = None

    def _next_round(self) -> Status | None:
        if self._items is None:
            self._items = _listed(self._scope.value(self._kind.source), "for_each goes through")
        if self._done == len(self._items):
            self.feedback_message = f"{self._done} items"
            return Status.SUCCESS
        self._scope.store.set(self._kind.item, self._items[self._done])
        return None

    def _progress(self) -> str:
        total = len(self._items or ())
        return f"{min(self._done + 1, total)} of {total}"


class ConsumeNode(RepeatingNode):
    """Takes the first item off a list key for each round, until the list is empty.

    What other nodes append meanwhile is taken as well. An item is off the list once its round has
    begun, whatever becomes of the round.
    """

    def __init__(
        self,
        kind: Consume,
        name: str,
        path: str,
        runtime: Runtime,
        body: Behaviour,
        scope: Scope,
        rounds: Rounds,
    ) -> None:
        super().__init__(name, path, runtime, body, rounds)
        self._kind = kind
        self._scope = scope

    def _next_round(self) -> Status | None:
        store, key = self._scope.store, self._kind.source.key
        items = _listed(store.get(key), "consume takes from")
        if not items:
            self.feedback_message = f"{self._done} items"
            return Status.SUCCESS
        store.set(key, items[1:])
        store.set(self._kind.item, items[0])
        return None

    def _progress(self) -> str:
        return f"item {self._done + 1}"


def _listed(items: Any, what: str) -> list[Any]:
    if not isinstance(items, list | tuple):
        raise ConfigError(f"{what} a list, got {type(items).__name__}")
    return list(items)
