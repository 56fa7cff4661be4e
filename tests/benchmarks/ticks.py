"""What a tick of a tree costs, beside the same tree of bare py_trees nodes.

Three trees of 500 leaves: a reactive sequence that asks 500 conditions and then goes on with an
action; a parallel with 500 running actions; and a sequence whose 500 actions all succeed in one
tick. Leaves do nothing, and events are not written. Given is the processor's time, the best of
several batches, so that other work on the machine counts little.
"""

import argparse
import gc
import json
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

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
USAGE = """examples:
  python tests/benchmarks/ticks.py
  python tests/benchmarks/ticks.py --batches 30 --json

exit status: 0 if every bound is kept, 1 if one is not"""


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
        bound_s: Longest time of a tick.
        unit: What the bound is given in.
        scale: From seconds to that.
    """

    name: str
    main: dict[str, Any]
    bare: Callable[[], Behaviour]
    bound_s: float
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
        1.2e-3,
        "ms",
        1e3,
    ),
    Measured(
        f"{LEAVES} running",
        {"parallel": [{"run": "Go", "name": f"go {number}"} for number in range(LEAVES)]},
        bare_parallel,
        0.8e-3,
        "ms",
        1e3,
    ),
    Measured(
        f"sequence of {LEAVES}, a child",
        {"sequence": [{"run": "Done"} for _ in range(LEAVES)]},
        bare_sequence,
        6e-6 * LEAVES,
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


def main() -> int:
    """Measure, and tell."""
    command = argparse.ArgumentParser(
        description=__doc__, epilog=USAGE, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    command.add_argument("--batches", type=int, default=15, help="of ticks (default: 15)")
    command.add_argument("--ticks", type=int, default=40, help="of a batch (default: 40)")
    command.add_argument("--json", action="store_true", help="answer as JSON")
    asked = command.parse_args()
    rows = []
    for kind in KINDS:
        own = best_s(ours(kind.main), asked.batches, asked.ticks)
        bare = best_s(kind.bare(), asked.batches, asked.ticks)
        rows.append(
            {
                "tree": kind.name,
                "unit": kind.unit,
                "ours": own * kind.scale,
                "py_trees": bare * kind.scale,
                "ratio": own / bare,
                "bound": kind.bound_s * kind.scale,
                "is_kept": own <= kind.bound_s,
            }
        )
    if asked.json:
        print(json.dumps(rows, indent=2))
    else:
        print(f"{'tree':30} {'ours':>10} {'bound':>9} {'py_trees':>10} {'ratio':>6}")
        for row in rows:
            print(
                f"{row['tree']:30} {row['ours']:7.3f} {row['unit']} {row['bound']:6.1f} "
                f"{row['unit']} {row['py_trees']:7.3f} {row['unit']} {row['ratio']:6.2f}"
                f"{'' if row['is_kept'] else '  over the bound'}"
            )
    return 0 if all(row["is_kept"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
