"""What the tree's nodes need from the mission that ticks them."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

from executive.clock import Clock
from executive.leaf.context import Context
from executive.leaf.store import Store


class Question(ABC):
    """A question put to the operator."""

    @abstractmethod
    def answer(self) -> bool | None:
        """Return yes, no, or None while it is open; polled once a tick, never blocking."""

    @abstractmethod
    def source(self) -> str:
        """Say who answered: `operator`, `option` (--answer) or `default`."""


class Runtime(ABC):
    """One running mission, as its nodes see it."""

    clock: Clock
    store: Store

    @abstractmethod
    def context(self, node: str) -> Context:
        """Return the context of the leaf at a node path."""

    @abstractmethod
    def record(self, kind: str, node: str, payload: Mapping[str, Any]) -> None:
        """Append a line to the journal."""

    @abstractmethod
    def ask(self, node: str, question: str, default: bool | None) -> Question:
        """Put a question to the operator."""

    @abstractmethod
    def fail(self, error: BaseException, node: str) -> None:
        """Take note of an error that escaped a leaf; a RobotError ends the mission in a safe stop
        after this tick.
        """
