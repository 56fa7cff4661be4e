"""A dry run as the nodes of its tree see it: mocked leaves, answered questions, a journal."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from py_trees.behaviour import Behaviour

from executive.config import Settings
from executive.coverage.sketch import Sketch
from executive.dry_run.chance import Chance
from executive.dry_run.mocked_leaf import MockedLeaf, Mocking
from executive.dry_run.script import MockedOutcome, MockedStatus, Script
from executive.events.event import Event
from executive.journal import Journal
from executive.leaf.action import Leaf
from executive.leaf.runtime import LeafMaker, Question
from executive.tree.leaf_nodes import RunNode
from executive.tree.modifiers import TimeoutNode

Preset = Callable[[Sequence[str]], bool | str | None]  # what --answer says to a question


class DryRuntime(Sketch):
    """What the nodes of one dry run share.

    Attributes:
        is_active: Something has happened in this tick, so that the next one may bring more.
    """

    def __init__(
        self,
        journal: Journal,
        chance: Chance,
        script: Script,
        preset: Preset,
        tell: Callable[[str, Any], None],
    ) -> None:
        super().__init__()
        self.journal = journal
        self.tick = 0
        self.is_active = False
        self._dues: set[float] = set()
        self._preset = preset
        self._outcomes = script.begin()
        self._mocking = Mocking(self, chance, tell)
        self._rngs: dict[str, np.random.Generator] = {}

    def heed(self, root: Behaviour) -> None:
        """Take note of the actions below a timeout, once the tree is built."""
        limits_s: dict[str, float] = {}
        for node in root.iterate():
            if isinstance(node, TimeoutNode):
                for below in node.iterate():
                    if isinstance(below, RunNode):
                        known_s = limits_s.get(below.path, node.limit_s)
                        limits_s[below.path] = min(known_s, node.limit_s)
        self._mocking.limits_s = limits_s

    def begin_tick(self, tick: int) -> None:
        """Begin a tick; the times before it are over."""
        self.tick, self.is_active = tick, False
        now_s = self.clock.now_s()
        self._dues = {one for one in self._dues if one > now_s}

    def next_due_s(self) -> float | None:
        """Return the next time at which a node does something else [s]; None if there is none."""
        return min(self._dues, default=None)

    # --- what the nodes see

    def leaf_maker(self, node: str, leaf: str, uses: Mapping[str, str]) -> LeafMaker:
        made: list[Any] = []

        def make(kind: type[Leaf[Any]], settings: Settings) -> Leaf[Any]:
            if not made:  # a leaf with computed settings is made anew at each start
                made.append(MockedLeaf(kind, node, self._mocking, self._outcomes.get(node)))
            mocked: Leaf[Any] = made[0]
            return mocked

        return make

    def due(self, at_s: float) -> None:
        if at_s <= self.clock.now_s():
            self.is_active = True
        else:
            self._dues.add(at_s)

    def record(self, node: str, event: Event) -> None:
        self.is_active = True
        self.journal.append(self.tick, self.clock.now_s(), node, event)

    def ask(
        self, node: str, question: str, default: bool | str | None, choices: Sequence[str] = ()
    ) -> Question:
        if node in self._outcomes:
            return _Answered(_meant(self._outcomes[node].take(), choices), "mock")
        preset = self._preset(choices)
        if preset is not None:
            return _Answered(preset, "option")
        rng = self._rngs.setdefault(node, self._rng(node))
        if choices:
            return _Answered(choices[int(rng.integers(len(choices)))], "seed")
        return _Answered(self._mocking.chance.holds(rng), "seed")

    def fail(self, error: Exception, node: str, leaf: str) -> str:
        raise error

    def _rng(self, node: str) -> np.random.Generator:
        return np.random.default_rng([self._mocking.chance.seed, *node.encode()])


class _Answered(Question):
    """A question that is answered at once."""

    def __init__(self, answer: bool | str, source: str) -> None:
        self._answer, self._source = answer, source

    def answer(self) -> bool | str | None:
        return self._answer

    def source(self) -> str:
        return self._source


def _meant(mocked: MockedOutcome, choices: Sequence[str]) -> bool | str:
    if not choices:
        return mocked.status is MockedStatus.SUCCESS
    return mocked.answer if mocked.status is MockedStatus.SUCCESS else ""
