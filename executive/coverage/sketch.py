"""A mission's tree, built to be looked at: its leaves do nothing, and no plugin is made."""

from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

from py_trees.behaviour import Behaviour

from executive.clock import SimulatedClock
from executive.config import Settings
from executive.errors import ExecutiveError
from executive.events.event import Event
from executive.leaf.action import Leaf
from executive.leaf.context import Context
from executive.leaf.runtime import LeafMaker, Question, Runtime
from executive.leaf.store import Store
from executive.tree.build import build_tree
from executive.tree.language import MissionFile


class NeverTickedError(ExecutiveError):
    """A tree that was built to be looked at was ticked."""


class _Blank:
    """Stands where a leaf would."""


class Sketch(Runtime):
    """What the nodes of a tree are built with when nobody will tick them."""

    def __init__(self) -> None:
        self.clock = SimulatedClock()
        self.store = Store()

    def context(self, node: str, uses: Mapping[str, str]) -> Context:
        return self._refuse(node)

    def leaf_maker(self, node: str, leaf: str, uses: Mapping[str, str]) -> LeafMaker:
        return _blank

    def record(self, node: str, event: Event) -> None:
        self._refuse(node)

    def ask(
        self, node: str, question: str, default: bool | str | None, choices: Sequence[str] = ()
    ) -> Question:
        return self._refuse(node)

    def fail(self, error: Exception, node: str, leaf: str) -> str:
        return self._refuse(node)

    def _refuse(self, node: str) -> NoReturn:
        raise NeverTickedError(f"{node}: this tree was built to be looked at")


def sketch_of(mission: MissionFile) -> Behaviour:
    """Return the nodes of a mission's tree; they cannot be ticked."""
    return build_tree(mission, Sketch())


def _blank(kind: type[Leaf[Any]], settings: Settings) -> Leaf[Any]:
    blank: Any = _Blank()  # nobody calls it
    leaf: Leaf[Any] = blank
    return leaf
