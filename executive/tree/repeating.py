"""Nodes that repeat their body: loop and for_each.

py_trees' ForEach ticks its child once on an empty list; here no items are a success that ticks
nothing.
"""

from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.errors import ConfigError
from executive.leaf.runtime import Runtime
from executive.tree.conditions import Answer
from executive.tree.language import ForEach
from executive.tree.nodes import Controller, Steps, stop_child
from executive.tree.wiring import Scope


class LoopNode(Controller):
    """Checks `until` before each round and after the last; a failing round is its failure.

    Without `until`, all rounds done is success; with it, `max` rounds without a yes are a failure.
    """

    def __init__(
        self,
        name: str,
        path: str,
        runtime: Runtime,
        body: Behaviour,
        until: Answer | None,
        max_rounds: int | None,
    ) -> None:
        super().__init__(name, path, runtime, [body])
        self._body = body
        self._until = until
        self._max = max_rounds
        self._done = 0

    def begin(self) -> None:
        self._done = 0

    def proceed(self) -> Steps:
        if self._body.status is not Status.RUNNING:
            end = self._end()
            if end is not None:
                return end
            stop_child(self._body, everything=True)
        yield from self._body.tick()
        if self._body.status is Status.FAILURE:
            return self.adopt(self._body)
        if self._body.status is Status.SUCCESS:
            self._done += 1
        self.feedback_message = f"round {min(self._done + 1, self._max or self._done + 1)}" + (
            f" of at most {self._max}" if self._max else ""
        )
        return Status.RUNNING

    def _end(self) -> Status | None:
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


class ForEachNode(Controller):
    """Ticks its body once for each item of a list; the first failing body is its failure."""

    def __init__(
        self, kind: ForEach, name: str, path: str, runtime: Runtime, body: Behaviour, scope: Scope
    ) -> None:
        super().__init__(name, path, runtime, [body])
        self._kind = kind
        self._body = body
        self._scope = scope
        self._items: list[Any] | None = None
        self._done = 0

    def begin(self) -> None:
        self._items = None
        self._done = 0

    def proceed(self) -> Steps:
        if self._items is None:
            self._items = self._fetched()
        if self._body.status is not Status.RUNNING:
            if self._done == len(self._items):
                self.feedback_message = f"{self._done} items"
                return Status.SUCCESS
            stop_child(self._body, everything=True)
            self._scope.store.set(self._kind.item, self._items[self._done])
        yield from self._body.tick()
        if self._body.status is Status.FAILURE:
            return self.adopt(self._body)
        if self._body.status is Status.SUCCESS:
            self._done += 1
        self.feedback_message = f"{min(self._done + 1, len(self._items))} of {len(self._items)}"
        return Status.RUNNING

    def _fetched(self) -> list[Any]:
        items = self._scope.value(self._kind.source)
        if not isinstance(items, list | tuple):
            raise ConfigError(f"for_each goes through a list, got {type(items).__name__}")
        return list(items)
