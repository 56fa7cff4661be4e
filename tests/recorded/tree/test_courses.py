"""What each kind of node does, tick by tick: to its end, halted before it, and begun again."""

import json
import random
import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from executive.tree.build import build_tree
from executive.tree.load import load_mission

FAKES = runpy.run_path(str(Path(__file__).parents[2] / "tree" / "conftest.py"))
RANDOM = runpy.run_path(str(Path(__file__).parents[2] / "tree" / "test_any_tree.py"))
TREES = 5  # of a kind


class Draw:
    """Draws leaves, conditions and small trees below the node that is looked at."""

    def __init__(self, seed: str) -> None:
        self._rng = random.Random(seed)

    def count(self, least: int, most: int) -> int:
        return self._rng.randint(least, most)

    def leaf(self) -> Any:
        ends = ["succeed", "succeed", "fail", "fail", "raise"]
        act = {"ticks": self.count(0, 4), "end": self._rng.choice(ends)}
        others = [{"check": "Sometimes"}, {"wait": 0.2}, {"set": {"a": self.count(1, 3)}}]
        return self._rng.choice([{"run": "Act", "with": act}] * 4 + others)

    def condition(self) -> Any:
        asked = ["Sometimes", {"not": "Sometimes"}, "{k} > 1", {"all": ["Sometimes", "{b}"]}]
        return self._rng.choice(asked)

    def node(self) -> Any:
        if self._rng.random() < 0.6:
            return self.leaf()
        inner = [self.leaf() for _ in range(self.count(1, 3))]
        kinds = ["sequence", "fallback", "reactive_fallback", "persistent_sequence", "not", "do"]
        kind = self._rng.choice(kinds)
        return {kind: inner[0]} if kind in ("not", "do") else {kind: inner}

    def nodes(self) -> list[Any]:
        return [self.node() for _ in range(self.count(1, 4))]


def _of(draw: Draw, most: int) -> tuple[list[Any], int]:
    nodes = draw.nodes()
    return nodes, 1 + most % len(nodes)


KINDS: dict[str, Callable[[Draw], Any]] = {
    "sequence": lambda d: {"sequence": d.nodes()},
    "fallback": lambda d: {"fallback": d.nodes()},
    "reactive_sequence": lambda d: {"reactive_sequence": d.nodes()},
    "reactive_fallback": lambda d: {"reactive_fallback": d.nodes()},
    "persistent_sequence": lambda d: {"do": {"persistent_sequence": d.nodes()}, "retry": 3},
    "not": lambda d: {"not": d.node()},
    "force_failure": lambda d: {"fallback": [{"force_failure": d.node()}, d.leaf()]},
    "if": lambda d: {"if": d.condition(), "then": d.node()},
    "if else": lambda d: {"if": d.condition(), "then": d.node(), "else": d.node()},
    "while else": lambda d: {
        "do": {"while": d.condition(), "do": d.node(), "else": d.node()},
        "timeout": 1,
    },
    "switch": lambda d: {
        "switch": "{k}",
        "cases": {str(d.count(1, 3)): d.node(), "7": d.node()},
        "else": d.node(),
    },
    "parallel": lambda d: {"parallel": d.nodes()},
    "parallel all": lambda d: {"parallel": d.nodes(), "wait_for_all": True},
    "parallel succeed": lambda d: dict(zip(("parallel", "succeed"), _of(d, 1), strict=True)),
    "parallel fail": lambda d: dict(zip(("parallel", "fail"), _of(d, 1), strict=True)),
    "loop": lambda d: {"loop": {"max": d.count(1, 3)}, "do": d.node()},
    "loop until": lambda d: {"loop": {"until": d.condition(), "max": 3}, "do": d.node()},
    "loop forever": lambda d: {"loop": "forever", "do": d.node(), "timeout": 0.5},
    "for each": lambda d: {"for_each": {"item": "x", "in": [1, 2, 3]}, "do": {"do": d.node()}},
    "consume": lambda d: {
        "sequence": [
            {"set": {"q": [1, 2]}},
            {"consume": {"item": "x", "from": "{q}"}, "do": {"do": d.node()}},
        ]
    },
    "retry": lambda d: {"do": d.node(), "retry": d.count(1, 3)},
    "retry pause": lambda d: {"do": d.node(), "retry": {"attempts": 3, "pause": "300 ms"}},
    "on_failure": lambda d: {"do": d.node(), "on_failure": d.node(), "retry": 2},
    "on_halt": lambda d: {
        "do": {"do": d.node(), "on_halt": {"set": {"a": d.count(1, 3)}}},
        "timeout": 0.2,
    },
    "optional": lambda d: {"sequence": [{"do": d.node(), "optional": True}, d.leaf()]},
    "if modifier": lambda d: {"fallback": [{"do": d.node(), "if": d.condition()}, d.leaf()]},
    "while modifier": lambda d: {"do": d.node(), "while": d.condition()},
    "timeout": lambda d: {"do": d.node(), "timeout": 0.1 * d.count(1, 4)},
    "once": lambda d: {"loop": {"max": 3}, "do": {"do": d.node(), "once": True}},
    "call": lambda d: {"sequence": [{"call": "inner", "in": {"n": "{k}"}}, d.leaf()]},
}
INNER = '\n  inner:\n    in: {n: int}\n    sequence: [{check: "{n} > 1"}, {wait: 0.2}]\n'


class Course:
    """A tree that is ticked, and the lines of what it did."""

    def __init__(self, path: Path, tree: Any, k: int) -> None:
        main = {"sequence": [{"set": {"k": k, "b": k != 1}}, tree]}
        text = f"{FAKES['HEADER']}trees:\n  main: {json.dumps(main)}{INNER}"
        path.write_text(text, encoding="utf-8")
        known = FAKES["TableCatalogue"]({**FAKES["LEAVES"], **RANDOM["LEAVES"]}, FAKES["PLUGINS"])
        self.runtime = FAKES["FakeRuntime"]()
        self.runtime.can_do_without = True
        mission = load_mission(str(path), (), known)
        self.play = FAKES["Play"](build_tree(mission, self.runtime), self.runtime)
        self.lines: list[str] = []

    def tick(self) -> bool:
        """Tick once; return whether the tree still runs."""
        status = self.play.tick()
        self._note(f"tick {self.play.ticks} {status} {self.play.reason}")
        return status == "RUNNING"

    def halt(self) -> None:
        self.play.halt()
        self._note("halted")

    def _note(self, line: str) -> None:
        for kind, node, payload in self.runtime.lines:
            told = " ".join(f"{name}={value}" for name, value in payload.items())
            self.lines.append(f"{kind} {node} {told}")
        self.runtime.lines.clear()
        nodes = [(one.status.name[0], one.is_skipped) for one in self.play.root.iterate()]
        self.lines.append(line)
        self.lines.append("".join(s.lower() if left_out else s for s, left_out in nodes))


@pytest.mark.parametrize("kind", KINDS)
def test_courses(recorded, tmp_path, kind) -> None:
    told = {}
    for n in range(TREES):
        draw = Draw(f"{kind} {n}")
        tree = KINDS[kind](draw)
        course = Course(tmp_path / "mission.yaml", tree, k=1 + n % 3)
        for _ in range(draw.count(1, 3)):
            if not course.tick():
                break
        course.halt()
        for _ in range(60):
            if not course.tick():
                break
        told[f"{n}: {json.dumps(tree)}"] = "\n".join(course.lines)
    recorded(told)
