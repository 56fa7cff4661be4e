"""Plays a tree on the nodes of the executive, and tells what happened as program/player.cpp does.

A line a tick: the root's status (R, S, F, K for left out; H for a halt, X for a fault) and the
events of the leaves in their order: `R a+ c?1`.
"""

import json
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any

from py_trees.behaviour import Behaviour

from executive.clock import SimulatedClock
from executive.config import Settings
from executive.events.event import Event
from executive.interfaces.plugin import Plugin
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.context import Context
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.runtime import MissionFaultError, Question, Runtime
from executive.leaf.store import Store
from executive.tree.btcpp.export_xml import to_xml
from executive.tree.build import build_tree, halt
from executive.tree.catalogue import TableCatalogue
from executive.tree.language import MissionFile
from executive.tree.load import load_mission

STEP_S = 0.1
_LETTERS = {"RUNNING": "R", "SUCCESS": "S", "FAILURE": "F"}


class PlayedRuntime(Runtime):
    """What the nodes need, without a mission around them."""

    def __init__(self) -> None:
        self.clock = SimulatedClock()
        self.store = Store()
        self.tick = 0
        self.events: list[str] = []
        self.starts: dict[str, int] = {}
        self.told: list[str] = []  # what leaves were given

    def context(self, node: str, uses: Mapping[str, str]) -> Context:
        return PlayedContext(self)  # type: ignore[abstract]

    def record(self, node: str, event: Event) -> None:
        """Nothing is journalled."""

    def ask(
        self, node: str, question: str, default: bool | str | None, choices: Sequence[str] = ()
    ) -> Question:
        raise NotImplementedError

    def fail(self, error: Exception, node: str, leaf: str) -> str:
        self.is_faulted = True
        self.told.append(f"{leaf} at {node}: {error}")
        raise MissionFaultError(f"{leaf} failed: {error}") from error


class PlayedContext(Context):
    """A leaf's view of it."""

    def __init__(self, runtime: PlayedRuntime) -> None:
        self.runtime = runtime


PlayedContext.__abstractmethods__ = frozenset()  # type: ignore[attr-defined]


class ActSettings(Settings):
    id: str
    ticks: int = 0  # until it ends
    ends: str = "s"  # s or f, for each start; the last letter for all further ones; x raises


class Act(Action[ActSettings]):
    """Runs for some ticks, then ends as its script says."""

    def run(self) -> Steps[None]:
        runtime: PlayedRuntime = self.context.runtime  # type: ignore[attr-defined]
        name, ends = self.settings.id, self.settings.ends
        number = runtime.starts.get(name, 0)
        runtime.starts[name] = number + 1
        runtime.events.append(f"{name}+")
        try:
            for _ in range(self.settings.ticks):
                yield None
        except GeneratorExit:
            runtime.events.append(f"{name}!")
            raise
        end = ends[min(number, len(ends) - 1)]
        if end == "x":
            raise ArithmeticError(f"{name} raises")
        runtime.events.append(f"{name}={end}")
        return succeeded() if end == "s" else failed(f"{name} failed")


class TellSettings(Settings):
    values: Any = ""


class Tell(Action[TellSettings]):
    """Notes what it is given."""

    def run(self) -> Steps[None]:
        yield from ()
        runtime: PlayedRuntime = self.context.runtime  # type: ignore[attr-defined]
        runtime.told.append(str(self.settings.values))
        return succeeded()


class GivenSettings(Settings):
    id: str
    answers: str = "1"  # for each tick; the last one for all further ticks


class Given(Condition[GivenSettings]):
    """Answers as its script says."""

    def check(self) -> Outcome[None]:
        runtime: PlayedRuntime = self.context.runtime  # type: ignore[attr-defined]
        answers = self.settings.answers
        answer = answers[min(runtime.tick, len(answers) - 1)]
        runtime.events.append(f"{self.settings.id}?{answer}")
        return succeeded() if answer == "1" else failed("not given")


__all__ = ["CATALOGUE", "Player", "loaded", "play", "to_xml"]
LEAVES = {leaf.__name__: leaf for leaf in (Act, Given, Tell)}
PLUGINS = {"robot": {"any": Plugin}, "estimation": {"any": Plugin}}
CATALOGUE = TableCatalogue(LEAVES, PLUGINS)


def loaded(main: Any, trees: Mapping[str, Any] | None = None) -> MissionFile:
    """Load a mission whose tree `main` is given as data.

    Raises:
        MissionFileError: If it has mistakes.
    """
    document = {
        "api": 1,
        "mission": "played",
        "plugins": {"robot": "any", "estimation": "any"},
        "trees": {"main": main, **(trees or {})},
    }
    with tempfile.NamedTemporaryFile("w", suffix=".yaml", encoding="utf-8") as file:
        file.write(json.dumps(document))
        file.flush()
        return load_mission(file.name, (), CATALOGUE)


class Player:
    """A tree that is ticked."""

    def __init__(self, mission: MissionFile, store: Mapping[str, Any] | None = None) -> None:
        self.runtime = PlayedRuntime()
        for key, value in (store or {}).items():
            self.runtime.store.set(key, value)
        self.root: Behaviour = build_tree(mission, self.runtime)

    @property
    def is_running(self) -> bool:
        return self.root.status.name == "RUNNING"

    def tick(self) -> str:
        """Tick once, and tell what happened."""
        try:
            self.root.tick_once()
        except MissionFaultError:
            halt(self.root)
            return self._line("X")
        self.runtime.tick += 1
        self.runtime.clock.advance(STEP_S)
        is_left_out = self.root.is_skipped and self.root.status.name == "SUCCESS"
        return self._line("K" if is_left_out else _LETTERS[self.root.status.name])

    def halt(self) -> str:
        """Halt the tree."""
        halt(self.root)
        return self._line("H")

    def _line(self, letter: str) -> str:
        events, self.runtime.events = self.runtime.events, []
        return " ".join([letter, *events])


def play(mission: MissionFile, ticks: int, halts: Sequence[int] = ()) -> list[str]:
    """Tick a mission so often; it ends where it is left out, or in a fault."""
    player = Player(mission)
    lines: list[str] = []
    for number in range(1, ticks + 1):
        lines.append(player.tick())
        if lines[-1][0] in "KX":
            break
        if number in halts:
            lines.append(player.halt())
    return lines
