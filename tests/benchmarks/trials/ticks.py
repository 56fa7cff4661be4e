"""Ticks of trees of many leaves that do nothing, beside the same trees of py_trees' own nodes."""

import gc
import json
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bounds import Bound, Figure, held
from py_trees.behaviour import Behaviour
from py_trees.behaviours import Running, Success
from py_trees.common import ParallelPolicy
from py_trees.composites import Parallel
from py_trees.composites import Sequence as BareSequence

from executive.clock import SimulatedClock
from executive.events.event import Event
from executive.interfaces.plugin import Plugin
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.context import Context
from executive.leaf.outcome import Outcome, succeeded
from executive.leaf.runtime import Question, Runtime
from executive.leaf.store import Store
from executive.tree.build import build_tree
from executive.tree.catalogue import TableCatalogue
from executive.tree.load import load_mission

LEAVES = 500


class Go(Action):
    """Goes on without end."""

    def run(self) -> Steps[None]:
        while True:
            yield None


class Done(Action):
    """Succeeds at once."""

    def run(self) -> Steps[None]:
        yield from ()
        return succeeded()


class Holds(Condition):
    """Holds."""

    def check(self) -> Outcome[None]:
        return succeeded()


class SilentRuntime(Runtime):
    """What nodes need, without a journal."""

    def __init__(self) -> None:
        self.clock = SimulatedClock()
        self.store = Store()

    def context(self, node: str, uses: Mapping[str, str]) -> Context:
        return None  # type: ignore[return-value]  # the leaves here need none

    def record(self, node: str, event: Event) -> None:
        """Nothing is written."""

    def ask(
        self, node: str, question: str, default: bool | str | None, choices: Sequence[str] = ()
    ) -> Question:
        raise NotImplementedError

    def fail(self, error: Exception, node: str, leaf: str) -> str:
        raise error


@dataclass(frozen=True, slots=True)
class Measured:
    """One kind of tree.

    Attributes:
        name: What it is.
        main: The tree for the executive.
        bare: The same of py_trees' own nodes.
        bound: Longest time of a tick, in the unit.
        unit: What the bound is given in.
        scale: From seconds to that.
    """

    name: str
    main: dict[str, Any]
    bare: Callable[[], Behaviour]
    bound: Bound
    unit: str
    scale: float


def bare_reactive() -> Behaviour:
    """Return a sequence without memory: its conditions are asked at each tick."""
    checks = [Success(f"{number}") for number in range(LEAVES)]
    return BareSequence("reactive", memory=False, children=[*checks, Running("last")])


def bare_parallel() -> Behaviour:
    """Return a parallel of running leaves."""
    children = [Running(f"{number}") for number in range(LEAVES)]
    return Parallel("parallel", policy=ParallelPolicy.SuccessOnAll(), children=children)


def bare_sequence() -> Behaviour:
    """Return a sequence that ends within one tick."""
    children = [Success(f"{number}") for number in range(LEAVES)]
    return BareSequence("sequence", memory=True, children=children)


KINDS = (
    Measured(
        f"{LEAVES} reactive checks",
        {"reactive_sequence": [*({"check": "Holds"} for _ in range(LEAVES)), {"run": "Go"}]},
        bare_reactive,
        Bound(1.2),
        "ms",
        1e3,
    ),
    Measured(
        f"{LEAVES} running",
        {"parallel": [{"run": "Go", "name": f"go {number}"} for number in range(LEAVES)]},
        bare_parallel,
        Bound(0.8),
        "ms",
        1e3,
    ),
    Measured(
        f"sequence of {LEAVES}, a child",
        {"sequence": [{"run": "Done"} for _ in range(LEAVES)]},
        bare_sequence,
        Bound(6.0),
        "us",
        1e6 / LEAVES,
    ),
)


def ours(main: dict[str, Any]) -> Behaviour:
    """Return the nodes of a tree."""
    for leaf in (Go, Done, Holds):
        leaf.claims = ()
    leaves = {leaf.__name__: leaf for leaf in (Go, Done, Holds)}
    plugins = {"robot": {"any": Plugin}, "estimation": {"any": Plugin}}
    document = {
        "api": 1,
        "mission": "ticks",
        "plugins": {"robot": "any", "estimation": "any"},
        "trees": {"main": main},
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "ticks.yaml"
        path.write_text(json.dumps(document), encoding="utf-8")
        mission = load_mission(str(path), (), TableCatalogue(leaves, plugins))
    return build_tree(mission, SilentRuntime())


def best_s(root: Behaviour, batches: int, ticks: int) -> float:
    """Return the shortest mean time of a tick over batches of ticks [s]."""
    root.tick_once()
    times = []
    gc.collect()
    gc.disable()
    try:
        for _ in range(batches):
            begun = time.process_time()
            for _ in range(ticks):
                root.tick_once()
            times.append((time.process_time() - begun) / ticks)
    finally:
        gc.enable()
    return min(times)


def measured(batches: int, ticks: int) -> list[Figure]:
    """Tick every kind of tree; return its time beside that of the bare nodes."""
    figures = []
    for kind in KINDS:
        own = kind.scale * best_s(ours(kind.main), batches, ticks)
        bare = kind.scale * best_s(kind.bare(), batches, ticks)
        words = f"{own:.3f} ({own / bare:.2f} times py_trees, {bare:.3f})"
        figures.append(held(f"{kind.name} [{kind.unit}]", own, kind.bound, words))
    return figures
