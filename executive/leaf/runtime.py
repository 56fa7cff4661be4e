"""What the tree's nodes need from the mission that ticks them."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Any, TypeAlias

from executive.clock import Clock
from executive.config import Settings
from executive.errors import ExecutiveError
from executive.events.event import Event
from executive.leaf.action import Leaf
from executive.leaf.context import Context
from executive.leaf.memory import Memory
from executive.leaf.store import Store


class MissionFaultError(ExecutiveError):
    """An error escaped a leaf or a plugin: the tick is cut off, and the mission ends."""


class Question(ABC):
    """A question put to the operator."""

    @abstractmethod
    def answer(self) -> bool | str | None:
        """Return yes or no, the choice, or None while it is open; polled once a tick, never
        blocking. A choice that nobody could make is an empty text.
        """

    @abstractmethod
    def source(self) -> str:
        """Return who answered: `operator`, `option` (--answer) or `default`; in a dry run also
        `mock` (a file) or `seed`.
        """


# Makes the leaf of a node from its class and its settings.
LeafMaker: TypeAlias = Callable[[type[Leaf[Any]], Settings], Leaf[Any]]


class Runtime(ABC):
    """One running mission, as its nodes see it."""

    clock: Clock
    store: Store
    uncounted_s: float = 0.0  # mission time that counts against no limit: of observing anew
    memory: Memory | None = None  # None: what leaves answer is not kept
    is_faulted: bool = False  # a fault has ended the mission; no leaf may begin

    @abstractmethod
    def context(self, node: str, uses: Mapping[str, str]) -> Context:
        """Return the context of the leaf at a node path.

        Args:
            node: The path.
            uses: Name of the plugin that the leaf uses, by capability, where there are several.
        """

    def leaf_maker(self, node: str, leaf: str, uses: Mapping[str, str]) -> LeafMaker:
        """Return what makes the leaf of a node; a dry run makes another one in its place.

        Args:
            node: Path of the node.
            leaf: Name of the behaviour.
            uses: As for `context`.
        """
        context = self.context(node, uses)
        return lambda kind, settings: kind(settings, context)

    def due(self, at_s: float) -> None:  # noqa: B027 - optional
        """Take note of a mission time at which a node does something else, whatever else happens.

        A dry run passes over the ticks before the next such time at which nothing can happen.

        Args:
            at_s: The time [s]; not later than now if the node goes on at the next tick.
        """

    def within(self, node: str, leaf: str) -> AbstractContextManager[object]:
        """Return the context of a leaf's own code, at a node path: its time, and who hangs."""
        return nullcontext()

    @abstractmethod
    def record(self, node: str, event: Event) -> None:
        """Append an event of a node to the journal."""

    @abstractmethod
    def ask(
        self, node: str, question: str, default: bool | str | None, choices: Sequence[str] = ()
    ) -> Question:
        """Put a question to the operator: yes or no, or one of the choices."""

    def limited_time_s(self) -> float:
        """Return the time that counts against limits [s].

        It is the mission's time without the time in which a resumed mission observed anew.
        """
        return self.clock.now_s() - self.uncounted_s

    def let_go(self, node: str, parts: tuple[str, ...]) -> None:  # noqa: B027 - optional
        """Take back the parts of the machine that a cancelled leaf drove: they may still move."""

    def still_driven(self, parts: tuple[str, ...]) -> str:
        """Return what a leaf that drives parts must wait for; empty if it may begin."""
        return ""

    def cut_short(self, parts: tuple[str, ...]) -> str:
        """Return why a leaf that is under way and drives parts must fail now; empty if it need not.

        A watched condition asks for it (`do: fail`).
        """
        return ""

    def keeps_failed(self, node: str, reason: str) -> bool:
        """Return whether a leaf that failed keeps its failure until the operator decides."""
        return False

    @abstractmethod
    def fail(self, error: Exception, node: str, leaf: str) -> str:
        """Take an error that escaped a leaf or a plugin that it called.

        The mission ends in a safe stop after this tick, whatever modifiers are around the node,
        unless the error is of a plugin that the mission can do without (`on_error: fail`).

        Args:
            error: What was raised.
            node: Path of the node.
            leaf: Name of the behaviour.

        Returns:
            One line for a person: what failed, where.

        Raises:
            MissionFaultError: If the mission ends for it.
        """
