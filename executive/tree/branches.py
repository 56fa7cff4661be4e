"""Nodes that choose one of their children: if/then/else, while/do/else, switch."""

from collections.abc import Mapping
from enum import Enum
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.leaf.runtime import Runtime
from executive.tree.conditions import Answer
from executive.tree.key_source import Source
from executive.tree.nodes import Controller, Steps, reset_children, stop_child
from executive.tree.wiring import Scope


class ChoosingNode(Controller):
    """Ticks one child at a time; a child that is no longer the chosen one is cancelled."""

    _chosen: Behaviour | None = None

    def begin(self) -> None:
        self._chosen = None
        reset_children(self)

    def follow(self, child: Behaviour) -> Steps:
        """Tick a child, after another one that still runs was cancelled."""
        if self._chosen is not None and self._chosen is not child:
            stop_child(self._chosen, everything=True)
        self._chosen = child
        yield from child.tick()
        return self.adopt(child)


class IfElseNode(ChoosingNode):
    """Asks a condition once, when it begins, and then ticks `then` or `else` to its end.

    Without an `else` it is left out when the condition does not hold.
    """

    is_asked_again = False

    def __init__(
        self,
        name: str,
        path: str,
        runtime: Runtime,
        answer: Answer,
        then: Behaviour,
        otherwise: Behaviour | None,
    ) -> None:
        children = [then] if otherwise is None else [then, otherwise]
        super().__init__(name, path, runtime, children)
        self._answer = answer
        self._then = then
        self._otherwise = otherwise

    def proceed(self) -> Steps:
        if self._chosen is not None and not self.is_asked_again:
            return (yield from self.follow(self._chosen))
        answer = self._answer()
        child = self._then if answer.success else self._otherwise
        if child is not None:
            return (yield from self.follow(child))
        self.feedback_message = f"left out: {answer.reason}" if answer.reason else "left out"
        self.is_skipped = self.is_refused = True
        return Status.SUCCESS


class WhileElseNode(IfElseNode):
    """Asks a condition once at each tick, and ticks `do` while it holds and `else` while not."""

    is_asked_again = True


class SwitchNode(ChoosingNode):
    """Compares a value with the names of its cases at each tick, and ticks the one that fits.

    Without an `else` a value that fits no case is a failure.
    """

    def __init__(
        self,
        name: str,
        path: str,
        runtime: Runtime,
        source: Source,
        cases: Mapping[str, Behaviour],
        otherwise: Behaviour | None,
        scope: Scope,
    ) -> None:
        children = [*cases.values(), *([] if otherwise is None else [otherwise])]
        super().__init__(name, path, runtime, children)
        self._source = source
        self._cases = cases
        self._otherwise = otherwise
        self._scope = scope

    @property
    def has_otherwise(self) -> bool:
        """Return whether a value that fits no case has a child of its own."""
        return self._otherwise is not None

    def proceed(self) -> Steps:
        text = case_text(self._scope.value(self._source))
        child = self._cases.get(text, self._otherwise)
        if child is not None:
            return (yield from self.follow(child))
        self.feedback_message = f"no case for '{text}' (cases: {', '.join(self._cases)})"
        self.is_refused = True
        return Status.FAILURE


def case_text(value: Any) -> str:
    """Return a value as a case names it: `true`, `3`, `large`; an enumeration by its value."""
    if isinstance(value, Enum):
        value = value.value
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value)
